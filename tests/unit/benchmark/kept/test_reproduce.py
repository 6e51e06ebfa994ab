"""A re-run against a reference: what is the same, what is inside the intervals, and everything that is not is named."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from benchmark.archive import archive
from benchmark.console import Console
from benchmark.errors import PredictionsError
from benchmark.reproduce import compare
from benchmark.verbs_results import reproduce

GEODESIC = "geodesic_median_deg"


@pytest.fixture
def kept(out: Path, tmp_path: Path) -> Path:
    archive(out, tmp_path / "kept")
    return tmp_path / "kept"


def _edit(path: Path, change: Callable[[Any], None]) -> None:
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def _set(out: Path, name: str, value: object) -> None:
    """Changes a field of the first method's summary, a figure's value."""

    def change(summaries: Any) -> None:
        summaries[0][name] = summaries[0][name] | {"value": value} if isinstance(summaries[0][name], dict) else value

    _edit(out / "entries/panel/0/summary.json", change)


def _figure(out: Path, name: str) -> dict[str, float]:
    figure: dict[str, float] = json.loads((out / "entries/panel/0/summary.json").read_text())[0][name]
    return figure


def test_the_same_results_reproduce_an_archive_without_data_sets(kept: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert reproduce(kept, out, Console()) == 0
    printed = capsys.readouterr().out
    assert printed.endswith("reproduced\n")
    assert "not reproduced" not in printed
    found = compare(kept, out)
    assert found.entries == {"same data": 2}
    assert found.counts("same data").keys() == found.counts("ranking").keys() == {"identical"}
    assert found.counts("same data").total() >= 2 * 8
    assert found.cpu_ratio == 1.0
    assert compare(kept, kept).is_reproduced
    assert compare(out, out).is_reproduced


def test_a_figure_inside_its_interval_counts_as_reproduced(kept: Path, out: Path) -> None:
    _set(out, GEODESIC, 0.5 * (_figure(out, GEODESIC)["low"] + _figure(out, GEODESIC)["value"]))
    found = compare(kept, out)
    assert found.is_reproduced
    assert found.counts("same data")["inside"] == 1


def test_a_figure_outside_its_interval_is_named_with_its_values(kept: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pushed = 1.001 * _figure(out, GEODESIC)["high"]
    _set(out, GEODESIC, pushed)
    assert reproduce(kept, out, Console()) == 1
    line = next(line for line in capsys.readouterr().out.splitlines() if GEODESIC in line)
    assert "panel, panel, steady, nav" in line
    assert f"{_figure(kept, GEODESIC)['value']:.6g}" in line
    assert f"{_figure(kept, GEODESIC)['low']:.6g} and {_figure(kept, GEODESIC)['high']:.6g}" in line
    assert f"{pushed:.6g}" in line


@pytest.mark.parametrize(("name", "value"), [("frames", 20), ("availability", 0.5), ("wrong_but_confident", 0.3)])
def test_frames_and_shares_of_frames_are_judged_too(kept: Path, out: Path, name: str, value: float) -> None:
    _set(out, name, value)
    assert [one.figure for one in compare(kept, out).outside] == [name]


def test_one_more_frame_without_an_answer_is_within_wilsons_interval(kept: Path, out: Path) -> None:
    """19 of 21 has the interval (0.711, 0.973)."""
    _set(out, "availability", 18 / 21)
    assert compare(kept, out).is_reproduced
    _set(out, "availability", 14 / 21)
    (figure,) = compare(kept, out).outside
    assert figure.stated is not None
    assert (figure.stated.low, figure.stated.high) == pytest.approx((0.7109, 0.9735), abs=1e-4)


def test_a_figure_that_the_re_run_lacks_is_outside(kept: Path, out: Path) -> None:
    def lose(summaries: Any) -> None:
        summaries[0][GEODESIC] = None

    _edit(out / "entries/panel/0/summary.json", lose)
    assert [(one.figure, one.found) for one in compare(kept, out).outside] == [(GEODESIC, None)]


def test_cpu_time_is_said_and_not_judged(kept: Path, out: Path) -> None:
    for place in (0, 1):
        _edit(out / f"entries/panel/{place}/summary.json", lambda summaries: summaries[0].update(cpu_s_per_frame=0.07))
    found = compare(kept, out)
    assert found.is_reproduced
    assert found.cpu_ratio == pytest.approx(7.0)


def test_a_missing_entry_is_named_and_an_added_one_is_no_fault(kept: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _edit(out / "results.json", lambda index: index.update(entries=index["entries"][:1]))
    assert reproduce(kept, out, Console()) == 1
    printed = capsys.readouterr().out
    assert "missing in the re-run" in printed
    assert printed.endswith("1 entries missing\n")
    assert compare(out, kept).added == 1
    assert compare(out, kept).missing == ()


def test_hostile_names_are_printed_plain(kept: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _edit(out / "results.json", lambda index: index.update(entries=index["entries"][:1]))
    _edit(out / "entries/panel/0/summary.json", lambda summaries: summaries[0].update(frames=1))
    _edit(kept / "results.json", lambda index: index["cases"][0].update(description="\x1b[2J"))
    (kept / "manifest.json").unlink()
    reproduce(kept, out, Console())
    printed = capsys.readouterr().out
    assert "[bold]b[/nothing]\N{REPLACEMENT CHARACTER}[31m :smile:" in printed
    assert "\x1b" not in printed


def test_other_data_sets_are_said_and_their_statistics_compared_all_the_same(
    kept: Path, make_results: Callable[..., Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = make_results(tmp_path / "other", seed=1)
    assert reproduce(kept, other, Console()) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "other data sets" in printed
    assert f"panel identity {_identity(kept):.12} in the reference, {_identity(other):.12} in the re-run" in printed
    assert compare(kept, other).entries == {"other data": 2}


def _identity(folder: Path) -> str:
    return str(json.loads((folder / "datasets/panel/manifest.json").read_text())["identity"])


def test_frames_of_the_same_identity_with_other_bytes_are_said(kept: Path, out: Path) -> None:
    path = out / "datasets/panel/frames/000003/frame.json"
    path.write_text(path.read_text() + " ")
    assert compare(kept, out).strange == {"panel": "same identity, 1 of 21 frames have other bytes"}
    assert compare(kept, out).is_reproduced
    shutil.rmtree(out / "datasets")
    assert compare(kept, out).strange == {}


@pytest.mark.parametrize("place", ["entries/panel/0/summary.json", "results.json", "datasets/panel/frames.json", "report.html"])
def test_an_edited_reference_is_found_before_anything_is_compared(
    kept: Path, out: Path, place: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (kept / place).write_bytes((kept / place).read_bytes() + b" ")
    assert reproduce(kept, out, Console()) == 1
    printed = capsys.readouterr().out
    assert f"{place}: its digest is" in " ".join(printed.split())
    assert printed.endswith("1 faults in the reference, nothing was compared\n")


def test_missing_and_strange_files_of_a_reference_are_found(kept: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (kept / "report.html").unlink()
    (kept / "notes.txt").write_text("mine")
    assert reproduce(kept, out, Console()) == 1
    printed = capsys.readouterr().out
    assert "report.html: it is missing" in printed
    assert "notes.txt: it does not belong to the reference" in printed


def test_a_damaged_manifest_is_one_sentence(kept: Path, out: Path) -> None:
    (kept / "manifest.json").write_text('{"format": "hardlight-reference", "version": 2}')
    with pytest.raises(PredictionsError, match=r"manifest\.json is damaged: version"):
        reproduce(kept, out, Console(quiet=True))


def test_without_results_there_is_one_sentence(kept: Path, tmp_path: Path) -> None:
    with pytest.raises(PredictionsError, match=r"holds no results\.json"):
        reproduce(kept, tmp_path / "nothing", Console(quiet=True))


def test_without_a_ranking_ranks_are_not_compared_and_that_is_said(
    kept: Path, out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _edit(out / "ranking.json", lambda ranking: ranking["rule"].update(unanswered_rad=1.0))
    assert compare(kept, out).unranked == "they were ranked by different rules"
    (out / "ranking.json").unlink()
    assert reproduce(kept, out, Console()) == 0
    assert f"ranks were not compared: {out} has no ranking.json" in capsys.readouterr().out
