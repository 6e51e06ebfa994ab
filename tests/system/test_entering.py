"""The outside methods that CONTRIBUTING.md shows are taken from it and really entered: one in Python, one a shell script."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from benchmark.conformance import examine
from benchmark.errors import PredictionsError
from benchmark.knowledge import declare
from benchmark.predictions import read
from estimators import registry
from scenes.dataset import Dataset


def block(repository: Path, language: str) -> str:
    """The only block in that language."""
    page = (repository / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (found,) = re.findall(rf"^```{language}\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    return str(found)


@pytest.fixture
def desk(tmp_path: Path, repository: Path, tiny_dataset: Path) -> Path:
    """A newcomer's folder: the page's module, and a data set where the page has it."""
    (tmp_path / "corners.py").write_text(block(repository, "python"), encoding="utf-8")
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "in-plane").symlink_to(tiny_dataset)
    return tmp_path


def run(command: list[str], desk: Path) -> str:
    """What the command said, run in the newcomer's folder with ``hardlight`` on the path."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(command, cwd=desk, capture_output=True, text=True, check=False, env=os.environ | {"PATH": path})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_module_is_entered_by_the_commands_of_the_page(repository: Path, desk: Path) -> None:
    page = (repository / "CONTRIBUTING.md").read_text(encoding="utf-8")
    commands = re.findall(r"^hardlight ((?:conform|estimate|judge) .*corners.*)$", page, re.MULTILINE)
    assert [one.split()[0] for one in commands] == ["conform", "estimate", "judge"]
    said = [run(["sh", "-c", f"hardlight {one}"], desk) for one in commands]
    assert "corners:Followed: every promise kept on 6 frames" in said[0]
    assert said[1] == "answers/corners: 6 ok\n"
    scores = pd.read_parquet(desk / "scores" / "corners" / "scores.parquet")
    assert scores["geodesic_deg"].max() < 3.0


def test_its_parameter_and_its_failures_work(desk: Path) -> None:
    blind = ["hardlight", "estimate", "corners:Followed", "data/in-plane", "--feature", "span", "--out", "blind", "--quiet"]
    assert run([*blind, "--set", "least_contrast_dn=1000"], desk).splitlines()[1] == "  the contrast is below 1000 DN"


def test_the_shell_script_is_a_method_too(repository: Path, desk: Path) -> None:
    said = run(["sh", "-e", "-c", block(repository, "bash")], desk)
    assert "answers/constant: no fault found" in said
    assert re.search(r"constant +6/6 ", said)
    answers = read(desk / "answers" / "constant")
    assert answers.record.method == "constant"
    assert answers.table["frame"].tolist() == list(range(6))


def test_the_shell_script_sees_an_empty_picture(repository: Path, desk: Path, tiny_dataset: Path) -> None:
    """Its other outcome, on copies of the pictures of which one is cut short."""
    copy = desk / "data" / "copy"
    for frame in sorted((tiny_dataset / "frames").iterdir()):
        picture = (frame / "nav.png").read_bytes()
        (copy / "frames" / frame.name).mkdir(parents=True)
        (copy / "frames" / frame.name / "nav.png").write_bytes(picture[:500] if frame.name == "000002" else picture)
    (copy / "manifest.json").write_text((tiny_dataset / "manifest.json").read_text())
    script = block(repository, "bash").replace("data=data/in-plane", "data=data/copy").partition("hardlight check")[0]
    run(["sh", "-e", "-c", script], desk)
    assert read(desk / "answers" / "constant").table["outcome"].tolist() == ["ok", "ok", "no_features", "ok", "ok", "ok"]


def test_check_and_conform_say_what_is_wrong(tiny_dataset: Path, desk: Path, hardlight: Callable[..., Any]) -> None:
    identity = json.loads((tiny_dataset / "manifest.json").read_text())["identity"]
    record = {"format": "hardlight-predictions", "version": 1, "method": "bad", "dataset_identity": identity}
    (desk / "run.json").write_text(json.dumps(record))
    head = "frame,sensor,outcome,qw,qx,qy,qz,tx_m,ty_m,tz_m,cpu_s,wall_s\n"
    (desk / "predictions.csv").write_text(head + "0,nav,ok,1,1,0,0,,,,,\n1,nav,okay,,,,,,,,,\n")
    ended = hardlight("check", desk, tiny_dataset)
    assert ended.status == 1
    assert ended.out.splitlines()[0] == f"{desk}/predictions.csv, line 2: the quaternion has length 1.41421, not 1"
    assert ended.out.splitlines()[-2] == "note: nav: 4 of 6 frames have no line (the first is 2) and count as skipped"
    assert ended.out.splitlines()[-1] == f"{desk}: 2 faults"
    with pytest.raises(PredictionsError, match=r"line 2: the quaternion has length 1\.41421, not 1"):
        read(desk)
    ended = hardlight("conform", "mono-rectangle", tiny_dataset, "--feature", "span", "--frames", 3)
    assert (ended.status, ended.out.splitlines()[-1]) == (0, "mono-rectangle: every promise kept on 3 frames")
    assert all(line.startswith("kept: ") for line in ended.out.splitlines()[:-1])


def test_conform_ends_with_1_where_a_promise_is_broken(
    tiny_dataset: Path, hardlight: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(Path(__file__).parent)
    ended = hardlight("conform", "misbehaving:Identity", tiny_dataset, "--feature", "span", "--frames", 2)
    assert ended.status == 1
    assert "broken: it answers no black picture and no empty scan, and says why" in ended.out
    assert "  a black picture in frame 0 is answered with a pose" in ended.out
    assert ended.out.splitlines()[-1] == "misbehaving:Identity: 2 promises broken"
    assert hardlight("conform", "misbehaving:Nobody", tiny_dataset, "--feature", "span").status == 2


def test_promises_that_cannot_be_tried_are_left_out(tiny_dataset: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(Path(__file__).parent)
    dataset = Dataset.open(tiny_dataset)
    recording = [dataset.observation(frame) for frame in dataset.frames[:2]]
    promises = examine(lambda: registry.load("misbehaving:Raises"), declare(dataset, "span").knowledge, recording)
    assert [promise.faults for promise in promises] == [
        ("the recording: it raises ZeroDivisionError: division by zero after 1 frames",)
    ]
