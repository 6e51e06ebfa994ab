"""What a method finds around it leads to no data set."""

import json
import sys
from pathlib import Path

import pytest

from benchmark.isolation.surroundings import SEARCH_PATH, clean, environment


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A data set's folder, and this process's working directory beside it."""
    (tmp_path / "data" / "in-plane" / "frames").mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "data" / "in-plane"


def test_variables_that_lead_to_it_are_left_out(data: Path) -> None:
    given = {
        "PATH": "/usr/bin:/bin",
        "LANG": "C.UTF-8",
        "EMPTY": "",
        "ABSOLUTE": str(data),
        "WITHIN": f"--data={data}/frames",
        "RELATIVE": "data/in-plane",
        "LISTED": "/usr/lib:data/in-plane/frames",
        "PWD": "/somewhere",
        "OLDPWD": "/elsewhere",
        "_": "/usr/bin/env",
    }
    assert clean(given, [Path("data/in-plane")]) == {"PATH": "/usr/bin:/bin", "LANG": "C.UTF-8", "EMPTY": ""}


def test_within_the_data_set_other_variables_stay(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(data)
    assert clean({"LANG": "C.UTF-8", "HERE": ".", "FRAMES": "frames"}, [Path()]) == {"LANG": "C.UTF-8"}


def test_modules_are_found_where_they_are_here_and_the_working_directory_last(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend("beside")
    monkeypatch.syspath_prepend(str(data))
    searched = json.loads(environment([data], with_working_directory=True)[SEARCH_PATH])
    assert searched[0] == str(Path("beside").absolute())
    assert searched[-1] == str(data.parents[1])
    assert str(data) not in searched
    assert [entry for entry in sys.path if entry in searched] == [entry for entry in searched if entry in sys.path]
    assert str(data.parents[1]) not in json.loads(environment([data], with_working_directory=False)[SEARCH_PATH])


def test_hashing_is_the_same_in_every_run(data: Path) -> None:
    found = environment([data], with_working_directory=False)
    assert (found["PYTHONHASHSEED"], found["PYTHONUNBUFFERED"]) == ("0", "1")
