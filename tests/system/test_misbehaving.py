"""Ten outside methods that misbehave, benched together with a good one: the leaderboard is complete and says what each did."""

import contextlib
import io
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from benchmark.cli import main

TEN = {
    "Raises": ({"ok": 3, "crashed": 1}, "ZeroDivisionError: division by zero"),
    "Hangs": ({"ok": 3, "timed_out": 1}, "no answer within 6 s"),
    "Leaks": ({"ok": 3, "crashed": 1}, "its process used more than 0.5 GiB"),
    "NotANumber": ({"ok": 3, "crashed": 1}, "step answered with a pose that is not one finite rotation and position"),
    "NotUnit": ({"ok": 3, "crashed": 1}, "step answered with a pose that is a Quaternion, not a Rotation"),
    "Identity": ({"ok": 4}, ""),
    "PoseWithFailure": ({"ok": 3, "crashed": 1}, "ValueError: outcome 'not_converged' and pose .* contradict each other"),
    "Prints": ({"ok": 4}, ""),
    "Mutates": ({"ok": 4}, ""),
    "Exits": ({"ok": 3, "crashed": 1}, "its process ended with status 3"),
}
HEAD = """
title = "Misbehaving"
description = "One good method among ten that are not"
limits = { step_timeout_s = 6.0, memory_gib = 0.5 }

[methods.good]
estimator = "mono-rectangle"

[[cases]]
name = "slice"
scenario = "./tiny.toml"
frames = "0:4"
features = ["wing"]

"""


@pytest.fixture(scope="module")
def benched(tiny_scenario: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Where the bench of all eleven left its results, and what it said."""
    folder = tmp_path_factory.mktemp("misbehaving")
    (folder / "tiny.toml").write_text(tiny_scenario.read_text())
    methods = "".join(f'[methods.{name.lower()}]\nestimator = "misbehaving:{name}"\n\n' for name in TEN)
    (folder / "suite.toml").write_text(HEAD + methods)
    said = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(said):
        patch.syspath_prepend(Path(__file__).parent)
        with pytest.raises(SystemExit, match="0"):
            main(["bench", str(folder / "suite.toml"), "--out", str(folder / "out"), "--quiet"])
    return folder / "out", said.getvalue()


def _entry(out: Path, name: str) -> Path:
    return out / "entries" / "slice" / "wing" / name.lower()


def _summary(out: Path, name: str) -> dict[str, Any]:
    (summary,) = json.loads((_entry(out, name) / "summary.json").read_text())
    return dict(summary)


@pytest.mark.slow
@pytest.mark.parametrize("name", TEN)
def test_each_has_its_outcome_and_its_reason(benched: tuple[Path, str], name: str) -> None:
    outcomes, reason = TEN[name]
    folder = _entry(benched[0], name)
    assert _summary(benched[0], name)["outcomes"] == outcomes
    extras = pd.read_parquet(folder / "extras.parquet").set_index("frame")["reason"]
    assert extras.drop(1).eq("").all()
    assert re.fullmatch(reason, extras[1], re.DOTALL), extras[1]


@pytest.mark.slow
def test_the_good_method_is_none_the_worse(benched: tuple[Path, str], hardlight: Callable[..., Any], tmp_path: Path) -> None:
    """It answers what it answers alone."""
    data = benched[0] / "datasets" / "slice"
    ended = hardlight("estimate", "mono-rectangle", data, "--feature", "wing", "--out", tmp_path / "a", "--quiet", "--in-process")
    assert ended.status == 0
    alone, among = (pd.read_csv(one / "predictions.csv") for one in (tmp_path / "a", _entry(benched[0], "good")))
    pd.testing.assert_frame_equal(
        alone.drop(columns=["cpu_s", "wall_s"]), among.drop(columns=["cpu_s", "wall_s"]), check_exact=True
    )


@pytest.mark.slow
def test_the_leaderboard_is_complete(benched: tuple[Path, str]) -> None:
    out, said = benched
    index = json.loads((out / "results.json").read_text())
    assert {entry["title"] for entry in index["entries"]} == {"good", *(name.lower() for name in TEN)}
    page = (out / "report.html").read_text()
    for name in ("good", *TEN):
        assert name.lower() in said
        assert name.lower() in page


@pytest.mark.slow
def test_the_identity_is_an_answer_and_wrong(benched: tuple[Path, str]) -> None:
    summary = _summary(benched[0], "Identity")
    assert (summary["answered"], summary["wrong"]) == (4, 4)


@pytest.mark.slow
def test_of_a_gigabyte_the_end_is_kept(benched: tuple[Path, str]) -> None:
    log = (_entry(benched[0], "Prints") / "log.txt").read_bytes()
    assert len(log) <= 64 * 1024 + 60
    assert log.endswith(b"x\nthe last line\n")
    assert log.startswith(b"[1073")
    assert not (_entry(benched[0], "Identity") / "log.txt").exists()


@pytest.mark.slow
def test_a_crash_costs_only_what_the_frame_took(benched: tuple[Path, str]) -> None:
    """Waiting costs time and no CPU; both stand in the row of its frame, and the restart in none."""
    table = pd.read_csv(_entry(benched[0], "Hangs") / "predictions.csv").set_index("frame")
    assert 6.0 <= table["wall_s"][1] < 8.0
    assert table["cpu_s"].max() < 0.5
    assert table["wall_s"].drop(1).max() < 0.5
