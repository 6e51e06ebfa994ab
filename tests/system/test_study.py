"""A study from end to end: points are rendered and answered alike, resumed without redoing, and differ by the factor alone."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmark.study import run, scores
from benchmark.study.outcomes import Outcomes, outcomes
from benchmark.study.points import points
from benchmark.study.spec import Study, load_study
from scenes.dataset import Dataset
from scenes.errors import ConfigError, UsageError
from tests.fly_around import FLY_AROUND
from tests.system.conftest import Ended

STUDY = """
title = "tiny"
design = "one-at-a-time"
frames = "0:3"
features = ["wing"]
bound_frames = "1"

[methods.mono-rectangle]
estimator = "mono-rectangle"

[scenario]
frame_count = 3
quality = "draft"
target = "zhai2014-target"
key_light = "sun"

# it stands behind the camera and shines away from the target
[scenario.lights.lamp]
base = "halogen-1kw"
position_m = [0.0, 0.0, -50.0]
aim_m = [0.0, 0.0, -100.0]

[factors.exposure]
title = "Exposure"
unit = "×"
paths = ["cameras.nav.exposure.time_s"]
how = "times"
levels = [0.03, 1.0]

[factors.nothing]
title = "Temperature of a lamp that shines away"
unit = "K"
paths = ["lights.lamp.temperature_k"]
levels = [2500, 3500]
"""
STUDY += FLY_AROUND

pytestmark = pytest.mark.slow


def study_of(folder: Path, text: str = STUDY) -> Study:
    (folder / "tiny.toml").write_text(text, encoding="utf-8")
    return load_study(str(folder / "tiny.toml"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("study")


@pytest.fixture(scope="module")
def done(folder: Path) -> Outcomes:
    run.study(study_of(folder), folder / "out", command="hardlight study tiny")
    return outcomes(folder / "out")


def test_points_are_the_scenario_and_each_level_off_it(done: Outcomes) -> None:
    assert done.points["moved"].tolist() == ["", "exposure", "nothing", "nothing"]
    assert done.points["exposure"].tolist() == [1.0, 0.03, 1.0, 1.0]
    assert done.points["nothing"].tolist() == [3200.0, 3200.0, 2500.0, 3500.0]
    assert done.points["point"].is_unique
    assert set(done.frames["point"]) == set(done.points["point"])
    assert [one.baseline for one in done.record.factors] == [1.0, 3200.0]


def test_a_factor_that_cannot_matter_changes_no_bit(folder: Path, done: Outcomes) -> None:
    """And one that matters does: the control without which the first half would say nothing."""
    base, exposure, *nothing = done.points["point"]
    frames = done.frames.set_index(["point", "frame"]).sort_index()
    columns = ["charge", "geodesic_deg", "lit_fraction", "bound_rotation_rad"]
    for name in nothing:
        pd.testing.assert_frame_equal(frames.loc[name][columns], frames.loc[base][columns])
        assert np.array_equal(_pixels(folder, name), _pixels(folder, base))
    assert not np.array_equal(_pixels(folder, exposure), _pixels(folder, base))
    known = frames["bound_rotation_rad"].dropna()
    assert known[exposure].iloc[0] > 3 * known[base].iloc[0]  # a thirtieth of the light


def test_the_bound_is_found_where_it_is_asked_for(done: Outcomes) -> None:
    assert done.frames.loc[done.frames["bound_asked"], "frame"].unique().tolist() == [1]
    assert done.frames["bound_determined"].sum() == len(done.points)


def test_a_second_run_redoes_nothing_and_an_interrupted_one_only_what_is_missing(folder: Path, done: Outcomes) -> None:
    out = folder / "out"
    before = {path: path.stat().st_mtime_ns for path in (out / "datasets").glob("*/frames/*/*")}
    lost = out / "datasets" / str(done.points["point"][3])
    for path in sorted((lost / "frames").glob("000002/*")):
        path.unlink()
    (lost / "frames" / "000002").rmdir()
    (lost / "truth.parquet").unlink()
    run.study(study_of(folder), out, command="hardlight study tiny")
    after = {path: path.stat().st_mtime_ns for path in (out / "datasets").glob("*/frames/*/*")}
    assert after.keys() == before.keys()
    changed = {path for path in after if after[path] != before[path]}
    assert {path.parent for path in changed} == {lost / "frames" / "000002"}
    pd.testing.assert_frame_equal(outcomes(out).frames.drop(columns="cpu_s"), done.frames.drop(columns="cpu_s"))


def test_a_study_is_kept_small_and_compared_with(folder: Path, done: Outcomes, hardlight: Callable[..., Ended]) -> None:
    """The verb finds everything done, scores it and writes the page; what is kept of it holds a re-run to its intervals."""
    out, kept = folder / "out", folder / "kept"
    said = hardlight("study", folder / "tiny.toml", "--out", out, "--quiet")
    assert said.status == 0
    assert "the page: " in said.out
    assert (out / "report.html").stat().st_size > 20_000
    assert hardlight("archive", out, "--to", kept).status == 0
    assert {path.name for path in kept.iterdir()} == {"study.json", "scores.json", "points.csv", "datasets.json", "report.html"}
    assert hardlight("reproduce", kept, out).status == 0
    text = (kept / "scores.json").read_text(encoding="utf-8")
    one = scores.read(kept).levels[0].charge
    elsewhere = text.replace(f'"value": {one.value!r}', '"value": 9.0').replace(f'"low": {one.low!r}', '"low": 8.9')
    (kept / "scores.json").write_text(elsewhere, encoding="utf-8")
    changed = hardlight("reproduce", kept, out)
    assert changed.status == 1
    assert "outside" in changed.out
    (kept / "mine.txt").write_text("mine")
    refused = hardlight("archive", out, "--to", kept)
    assert refused.status == 2
    assert "mine.txt" in refused.err


def test_a_plan_says_frames_time_and_disk_and_leaves_nothing(
    folder: Path, tmp_path: Path, hardlight: Callable[..., Ended], monkeypatch: pytest.MonkeyPatch
) -> None:
    study = study_of(folder)
    (tmp_path / "tiny.toml").write_text(STUDY, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    said = hardlight("study", "./tiny.toml", "--plan", "--workers", 2)
    assert said.status == 0
    assert said.out.startswith(f"{len(points(study))} points, {3 * len(points(study))} frames × 1 sensor: about ")
    assert "GB of disk" in said.out
    assert [path.name for path in tmp_path.iterdir()] == ["tiny.toml"]


def test_a_point_is_named_after_its_content(folder: Path, done: Outcomes) -> None:
    wider = STUDY.replace("levels = [0.03, 1.0]", "levels = [0.03, 0.5, 1.0, 2.0]")
    names = {point.name for point in points(study_of(folder, wider))}
    assert set(done.points["point"]) < names
    assert len(names) == len(done.points) + 2


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('paths = ["cameras.nav.exposure.time_s"]', 'paths = ["cameras.nav.exposure.tims_s"]', "did you mean 'time_s'"),
        ('design = "one-at-a-time"', 'design = "sphere"', "one factor, of type 'direction'"),
        ('features = ["wing"]', 'features = ["wong"]', "did you mean 'wing'"),
        ('bound_frames = "1"', 'bound_frames = "7"', "bound_frames"),
        ("levels = [2500, 3500]", "levels = [2500, 2500]", "twice"),
        ('title = "tiny"', 'title = "tiny"\nreferences = { mono = "mono" }', "method of this study"),
    ],
)
def test_faults_of_a_study_are_named(tmp_path: Path, old: str, new: str, says: str) -> None:
    with pytest.raises(ConfigError, match=says):
        study_of(tmp_path, STUDY.replace(old, new))


def test_a_point_that_cannot_be_asked_about_is_left_out_and_said(tmp_path: Path) -> None:
    """From too near the wing is not in the picture, so its corners cannot be told; the other points are there."""
    text = STUDY.replace('paths = ["lights.lamp.temperature_k"]', 'paths = ["motion.range_m"]')
    text = text.replace("levels = [2500, 3500]", "levels = [12, 100]").replace('bound_frames = "1"', "")
    run.study(study_of(tmp_path, text), tmp_path / "out")
    found = outcomes(tmp_path / "out")
    assert ["not wholly in the picture" in reason for reason in found.record.refused.values()] == [True]
    assert found.points["moved"].tolist() == ["", "exposure"]
    assert set(found.frames["point"]) == set(found.points["point"])


def test_a_level_that_makes_no_scenario_is_refused_before_anything_is_rendered(tmp_path: Path) -> None:
    text = STUDY.replace('paths = ["lights.lamp.temperature_k"]', 'paths = ["lights.lamp.position_m.2"]')
    study = study_of(tmp_path, text.replace("levels = [2500, 3500]", "levels = [-50, -100]"))
    with pytest.raises(UsageError, match="points nowhere"):
        points(study)


def _pixels(folder: Path, point: str) -> np.ndarray:
    return Dataset.open(folder / "out" / "datasets" / point).observation(2).images["nav"].pixels
