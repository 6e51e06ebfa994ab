"""The search from end to end: it finds the light that a planted weakness hangs on, shows it, goes on after a kill."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

from benchmark import results
from benchmark.console import Console
from benchmark.study import search_page, search_trials
from benchmark.study.search_hunt import Hunt, narrowed
from benchmark.study.search_record import FILE, WorstRecord
from benchmark.study.search_run import worst
from benchmark.study.search_worst import PICTURE
from benchmark.study.spec import load_study
from benchmark.verbs import report
from scenes.dataset import Dataset
from scenes.errors import UsageError
from tests.fly_around import FLY_AROUND

# ``attitude_xyzw`` is the one frame's truth
STUDY = """
title = "tiny"
design = "sphere"
frames = "0:1"
features = ["wing"]

[methods.half-blind]
estimator = "half_blind:HalfBlind"
parameters = { attitude_xyzw = [-0.40557979, -0.40557979, 0.57922797, -0.57922797] }

[methods.all-seeing]
estimator = "half_blind:AllSeeing"
parameters = { attitude_xyzw = [-0.40557979, -0.40557979, 0.57922797, -0.57922797] }

[factors.sun]
type = "direction"
title = "Sun"
light = "sun"
count = 4

[scenario]
frame_count = 1
quality = "draft"
target = "zhai2014-target"
key_light = "sun"
"""
STUDY += FLY_AROUND
TRIALS = 16

pytestmark = pytest.mark.slow


def searched(folder: Path, method: str, trials: int, out: str = "out") -> WorstRecord:
    study = narrowed(load_study(str(folder / "tiny.toml")), method, None, False)
    return worst(Hunt(study, method, None, trials, 0, "tpe", False), folder / out)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("worst")
    (made / "tiny.toml").write_text(STUDY, encoding="utf-8")
    return made


@pytest.fixture(scope="module", autouse=True)
def _methods_are_found() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(Path(__file__).parent)
        yield


@pytest.fixture(scope="module")
def found(folder: Path) -> WorstRecord:
    return searched(folder, "half-blind", TRIALS)


def test_the_light_that_hurts_is_found(folder: Path, found: WorstRecord) -> None:
    """Judged by the pictures themselves: at the worst point, and wherever it fails, they are brighter left."""
    assert found.is_found
    assert found.worst is not None
    assert found.trials[found.worst].right == 0
    assert all(one.is_failure == is_brighter_left(folder, one.point) for one in found.trials)
    assert 0 < sum(one.is_failure for one in found.trials) < TRIALS


def is_brighter_left(folder: Path, point: str) -> bool:
    pixels = Dataset.open(folder / "out" / "datasets" / point).observation(0).images["nav"].pixels
    return bool(pixels[:, :320].mean() > 1.02 * pixels[:, 320:].mean())


def test_the_worst_points_frame_has_a_bound(folder: Path, found: WorstRecord) -> None:
    """Somebody could have known: the picture is bright enough, as the other method's answer there shows."""
    assert found.bound is not None
    assert found.bound.rotation_rad is not None
    assert 0 < found.bound.rotation_rad < np.radians(0.5)
    assert len(list((folder / "out" / "bounds").glob("*.parquet"))) == 1


def test_the_folder_is_a_studys(folder: Path, found: WorstRecord) -> None:
    index = results.read(folder / "out")
    assert {case.name for case in index.cases} == {one.point for one in found.trials}
    assert {entry.title for entry in index.entries} == {"half-blind"}


def test_the_page_shows_the_worst_frame(folder: Path, found: WorstRecord) -> None:
    text = search_page.write(folder / "out").read_text(encoding="utf-8")
    assert found.worst is not None
    assert found.trials[found.worst].label in text
    assert "brighter left" not in found.sentence
    assert "http://" not in text.replace("http://www.w3.org", "")
    assert "https://" not in text
    report(folder / "out", Console(quiet=True))
    assert (folder / "out" / "report.html").read_text(encoding="utf-8") == text  # not the study's
    drawn = cv2.imread(str(folder / "out" / PICTURE))
    assert drawn is not None
    assert drawn.shape == (256, 1280, 3)  # the whole frame, twice as large
    blue, green, red = np.moveaxis(drawn.astype(int), -1, 0)
    assert np.count_nonzero(green - np.maximum(blue, red) > 40) > 500  # the true outline
    assert np.count_nonzero(red - green > 40) == 0  # no answer, no outline of one


def test_a_finished_search_returns_at_once(folder: Path, found: WorstRecord, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search_trials, "run_points", None)
    assert searched(folder, "half-blind", TRIALS) == found


def test_a_killed_search_does_the_missing_trials_alone_and_comes_out_the_same(folder: Path, found: WorstRecord) -> None:
    """Killed in the last trial but two, after it was rendered: nothing is rendered again."""
    out = folder / "out"
    (journal,) = out.glob("*.journal")
    lines = trials_in(journal)
    journal.write_bytes(journal.read_bytes().partition(lines[-3][:300])[0] + lines[-3][:30])
    (out / FILE).unlink()
    before = {path: path.stat().st_mtime_ns for path in (out / "datasets").glob("*/frames/*/*")}
    assert searched(folder, "half-blind", TRIALS) == found
    assert {path: path.stat().st_mtime_ns for path in (out / "datasets").glob("*/frames/*/*")} == before
    assert len(trials_in(journal)) == len(lines) == TRIALS


def trials_in(journal: Path) -> list[bytes]:
    return [line for line in journal.read_bytes().splitlines(keepends=True) if b'"distributions"' in line]


def test_of_a_method_without_the_weakness_no_failure_is_found(folder: Path, found: WorstRecord) -> None:
    """The control: the same pictures, and a method that answers whatever the light."""
    shutil.copytree(folder / "out" / "datasets", folder / "control" / "datasets")
    control = searched(folder, "all-seeing", 4, out="control")
    assert found.is_found
    assert not control.is_found
    assert control.sentence.startswith("No failure of all-seeing was found in 4 trials")


def test_an_unknown_method_is_refused(folder: Path) -> None:
    with pytest.raises(UsageError, match="half-blind"):
        searched(folder, "half-blond", 4)
