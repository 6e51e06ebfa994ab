"""Studies that would say something else than they seem to are refused with a sentence."""

from pathlib import Path

import pytest

from benchmark import run_bounds
from benchmark.study import run
from benchmark.study.points import points
from benchmark.study.search_hunt import narrowed
from benchmark.study.spec import Study, load_study
from scenes.errors import ConfigError, UsageError

STUDY = """
title = "tiny"
design = "factorial"
frames = "0:3"
features = ["wing"]
methods.mono-rectangle.estimator = "mono-rectangle"

[scenario]
frame_count = 3
quality = "draft"
target = "zhai2014-target"
key_light = "sun"
cameras.nav = { base = "guppy-f125b", width_px = 640, height_px = 128 }
lights.sun = "sun"
lights.lamp = { base = "halogen-1kw", position_m = [0.0, 0.0, -50.0], aim_m = [0.0, 0.0, -100.0] }
motion = { type = "axis-sweep", axis = "y", start_deg = 20.0, rate_deg_s = 1.0, range_m = 100.0 }
"""

RANGE = '\n[factors.{name}]\ntitle = "Range"\npaths = ["motion.range_m"]\nhow = "{how}"\nlevels = {levels}\n'
EXPOSURE = '\n[factors.exposure]\ntitle = "Exposure"\npaths = {paths}\nhow = "times"\nlevels = [0.5, 2.0]\n'
SUN = '\n[factors.sun]\ntype = "direction"\ntitle = "Sun"\nlight = "sun"\ncount = 2\n'
DISTANCE = '\n[factors.far]\ntype = "distance"\ntitle = "Distance"\nlight = "lamp"\nlevels = [-3, 2]\n'


def study_of(folder: Path, factors: str, design: str = "factorial") -> Study:
    (folder / "tiny.toml").write_text(STUDY.replace("factorial", design) + factors, encoding="utf-8")
    return load_study(str(folder / "tiny.toml"))


def a_range(name: str, how: str = "set", levels: str = "[90, 110]") -> str:
    return RANGE.format(name=name, how=how, levels=levels)


@pytest.mark.parametrize("name", ["point", "moved", "label"])
def test_a_factor_has_a_column_of_its_own(tmp_path: Path, name: str) -> None:
    with pytest.raises(ConfigError, match=rf"factors\.{name}: .* column"):
        study_of(tmp_path, a_range(name))


def test_a_factor_is_not_called_after_a_part_of_a_direction(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"factors\.sun_x: .* column"):
        study_of(tmp_path, SUN + a_range("sun_x"))
    assert len(points(study_of(tmp_path, SUN + a_range("sun_w")))) == 4


@pytest.mark.parametrize(
    "paths",
    [
        '["cameras.nav.exposure.time_s", "cameras.nav.exposure.time_s"]',
        '["cameras.nav.exposure.time_s", "cameras.*.exposure.time_s"]',
    ],
)
def test_a_place_is_changed_once(tmp_path: Path, paths: str) -> None:
    """Or a factor of 2 would be one of 4."""
    with pytest.raises(ConfigError, match="leads to what another"):
        study_of(tmp_path, EXPOSURE.format(paths=paths))


def test_a_factor_that_a_later_one_replaces_is_refused_where_they_are_combined(tmp_path: Path) -> None:
    """One at a time they do not meet; and a number that is set and then multiplied is changed by both."""
    both = a_range("near") + a_range("far", levels="[80, 120]")
    for design in ("factorial", "sobol"):
        with pytest.raises(ConfigError, match=r"factors.far: it replaces what factors.near"):
            study_of(tmp_path, both, design)
    apart = study_of(tmp_path, both, "one-at-a-time")
    assert len(points(apart)) == 5
    with pytest.raises(UsageError, match=r"a search combines .* one at a time: factors.far: it replaces what factors.near"):
        narrowed(apart, next(iter(apart.methods)), None, avoid_dark=False)
    assert len({one.name for one in points(study_of(tmp_path, a_range("near") + a_range("times", "times", "[1, 2]")))}) == 4
    with pytest.raises(ConfigError, match=r"factors.near: it replaces"):
        study_of(tmp_path, a_range("times", "times", "[1, 2]") + a_range("near"))


def test_a_level_that_takes_the_frames_away_is_refused_with_a_sentence(tmp_path: Path) -> None:
    frames = '\n[factors.frames]\ntitle = "Frames"\npaths = ["frame_count"]\nlevels = [2, 3]\n'
    with pytest.raises(UsageError, match=r"at Frames 2 the scenario is refused: frames '0:3' lies outside"):
        points(study_of(tmp_path, frames))


def test_numbers_that_cannot_be_are_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="a distance is above zero, and the lowest is -3"):
        study_of(tmp_path, DISTANCE)
    with pytest.raises(ConfigError, match="above zero, and the lowest is -1"):
        study_of(tmp_path, a_range("far", levels='[-1, 2]\nscale = "log"\nrange = [1, 2]'))


def test_bounds_that_nobody_asks_for_any_more_are_forgotten(tmp_path: Path) -> None:
    (tmp_path / run_bounds.FOLDER).mkdir()
    for name in ("one.parquet", "other.parquet"):
        (tmp_path / run_bounds.FOLDER / name).write_text("")
    run_bounds.forget(tmp_path, ["one", "never"])
    assert [path.name for path in (tmp_path / run_bounds.FOLDER).iterdir()] == ["other.parquet"]


def test_a_study_of_which_nothing_can_be_done_leaves_what_lies_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An empty index beside another try's points and scores would be read as one with them."""
    monkeypatch.setattr(run, "do", lambda job: f"{job.case.name} is in the dark")
    (tmp_path / "results.json").write_text("as it was")
    with pytest.raises(UsageError, match=r"no point could be done; the first: p[0-9a-f]{10} is in the dark"):
        run.study(study_of(tmp_path, a_range("far")), tmp_path)
    assert (tmp_path / "results.json").read_text() == "as it was"
    assert not (tmp_path / "study.json").exists()
