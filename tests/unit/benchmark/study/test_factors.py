"""Factors: levels, edits of a scenario's tree, directions of equal area."""

from typing import Any

import numpy as np
import pytest

from benchmark.study import directions
from benchmark.study.edits import edited, found, times
from benchmark.study.factor import ArcFactor, DirectionFactor, DistanceFactor, NumberFactor
from scenes.errors import UsageError

TREE: dict[str, Any] = {
    "lights": {
        "sun": {"type": "sun", "frame": "chaser", "direction": [0.0, 0.0, -2.0]},
        "lamp": {"type": "halogen", "frame": "chaser", "position_m": [-3.0, 0.0, 3.0], "aim_m": [0.0, 0.0, 7.0]},
        "other": {"type": "sun", "frame": "target", "direction": [0.0, 0.0, -1.0]},
    },
    "target": {
        "parts": [
            {"name": "body", "material": {"roughness": 0.1, "reflectance": {"wavelength_nm": [300, 1100], "value": [0.2, 0.4]}}},
            {"name": "panel", "material": {"roughness": 0.3}},
            {"name": "paint", "material": {"reflectance": 0.7}},
        ]
    },
}


def test_an_edit_leaves_the_tree_as_it_was_and_changes_only_what_it_names() -> None:
    changed = edited(TREE, "target.parts.panel.material.roughness", lambda _: 0.5)
    assert changed["target"]["parts"][1]["material"]["roughness"] == 0.5
    assert TREE["target"]["parts"][1]["material"]["roughness"] == 0.3
    changed["target"]["parts"][1]["material"]["roughness"] = 0.3
    assert changed == TREE


def test_a_star_stands_for_every_entry_that_has_the_rest() -> None:
    assert found(TREE, "target.parts.*.material.roughness") == [0.1, 0.3]
    assert found(TREE, "target.parts.1.material.roughness") == [0.3]


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("target.parts.panle.material.roughness", "did you mean 'panel'"),
        ("target.part", "did you mean 'parts'"),
        ("target.parts.*.material.colour", "nothing in it has material.colour"),
        ("lights.sun.frame.x", "neither a table nor a list"),
        ("target.parts.7.material", "parts"),
    ],
)
def test_a_path_that_leads_nowhere_is_named(path: str, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        edited(TREE, path, lambda value: value)


def test_times_multiplies_numbers_lists_and_spectra_and_nothing_else() -> None:
    assert times(2.0)(3.0) == 6.0
    assert times(2.0)([1.0, 2.0]) == [2.0, 4.0]
    assert times(0.5)({"wavelength_nm": [300, 1100], "value": [0.2, 0.4]}) == {"wavelength_nm": [300, 1100], "value": [0.1, 0.2]}
    for wrong in ("text", None, True, {"draw": "uniform"}):
        with pytest.raises(UsageError):
            times(2.0)(wrong)


def test_levels_are_those_named_or_evenly_spread() -> None:
    named = NumberFactor(title="x", paths=("a",), levels=(3.0, 1.0))
    assert named.values == (1.0, 3.0)
    spread = NumberFactor(title="x", paths=("a",), range=(0.25, 4.0), steps=5, scale="log")
    assert np.allclose(spread.values, [0.25, 0.5, 1.0, 2.0, 4.0])
    assert spread.at(np.array([0.5])) == 1.0


def test_a_scenario_has_a_number_where_all_its_places_have_that_one() -> None:
    """Or a level equal to the first place's would be left out as the scenario's own."""
    every = NumberFactor(title="x", paths=("target.parts.*.material.roughness",), levels=(0.1, 0.3))
    assert every.baseline(TREE) is None
    assert every.baseline(every.applied(TREE, 0.3)) == 0.3
    two = NumberFactor(title="x", paths=("target.parts.0.material.roughness", "target.parts.1.material.roughness"), levels=(1.0,))
    assert two.baseline(TREE) is None
    assert NumberFactor(title="x", paths=two.paths[:1], levels=(1.0,)).baseline(TREE) == 0.1
    assert NumberFactor(title="x", paths=two.paths, levels=(1.0,), how="times").baseline(TREE) == 1.0


@pytest.mark.parametrize(
    "wrong",
    [
        {},
        {"levels": (1.0, 1.0)},
        {"range": (2.0, 1.0)},
        {"range": (0.0, 1.0), "scale": "log"},
        {"levels": (-1.0, 2.0), "scale": "log"},
    ],
)
def test_levels_that_cannot_be_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"level|range|log"):
        NumberFactor(title="x", paths=("a",), **wrong)


def test_phase_angle_and_azimuth_are_what_the_observer_sees() -> None:
    assert np.allclose(directions.towards(0.0, 33.0), [0, 0, -1])  # behind the camera
    assert np.allclose(directions.towards(90.0, 0.0), [1, 0, 0], atol=1e-15)  # from the right
    assert np.allclose(directions.towards(90.0, 90.0), [0, 1, 0], atol=1e-15)  # from below
    assert np.allclose(directions.towards(180.0, 0.0), [0, 0, 1], atol=1e-15)  # behind the target
    rng = np.random.default_rng(1)
    for phase, azimuth in zip(rng.uniform(1, 179, 20), rng.uniform(0, 360, 20)):
        assert np.allclose(directions.angles_deg(directions.towards(phase, azimuth)), (phase, azimuth))
    assert [directions.side(one) for one in (0, 44, 91, 359)] == ["right", "below right", "below", "right"]


def test_directions_share_the_sphere_evenly() -> None:
    """Second moments of an even cover are I/3, means vanish, and no two are much closer than their share allows."""
    grid = directions.equal_area(200)
    assert np.allclose(np.linalg.norm(grid, axis=1), 1)
    assert np.allclose(grid.mean(axis=0), 0, atol=0.01)
    assert np.allclose(grid.T @ grid / 200, np.eye(3) / 3, atol=0.01)
    cosine = grid @ grid.T - 2 * np.eye(200)
    nearest = np.arccos(cosine.max(axis=1))
    assert nearest.min() > 0.7 * np.sqrt(4 * np.pi / 200)


def test_random_places_of_the_unit_square_are_even_on_the_part_of_the_sphere_asked_for() -> None:
    unit = np.random.default_rng(0).random((20_000, 2))
    there = directions.on_sphere(unit, (30.0, 120.0))
    phase = np.degrees(np.arccos(-there[:, 2]))
    assert phase.min() > 30 - 1e-9
    assert phase.max() < 120 + 1e-9
    first, last = np.cos(np.radians([30.0, 120.0]))
    share = (first - np.cos(np.radians(60.0))) / (first - last)
    assert np.mean(phase < 60) == pytest.approx(share, abs=0.01)


def test_a_direction_moves_a_distant_light_and_turns_a_lamp_about_its_aim() -> None:
    sun = DirectionFactor(type="direction", title="Sun", light="sun", count=8)
    assert sun.baseline(TREE) == (0.0, 0.0, -1.0)
    assert sun.applied(TREE, (1.0, 0.0, 0.0))["lights"]["sun"]["direction"] == [1.0, 0.0, 0.0]
    lamp = DirectionFactor(type="direction", title="Lamp", light="lamp", count=8)
    assert lamp.baseline(TREE) == pytest.approx((-0.6, 0.0, -0.8))
    moved = lamp.applied(TREE, (0.0, -1.0, 0.0))["lights"]["lamp"]["position_m"]
    assert moved == pytest.approx([0.0, -5.0, 7.0])  # 5 m from the aim, as before, above it


def test_an_arc_goes_through_where_the_light_stands() -> None:
    arc = ArcFactor(type="arc", title="Lamp", light="lamp", levels=(0.0, 60.0, 90.0))
    own = arc.baseline(TREE)
    assert own == pytest.approx(np.degrees(np.arctan2(3, 4)), abs=1e-5)
    assert isinstance(own, float)
    assert arc.applied(TREE, own)["lights"]["lamp"]["position_m"] == pytest.approx([-3.0, 0.0, 3.0], abs=1e-5)
    assert arc.applied(TREE, 90.0)["lights"]["lamp"]["position_m"] == pytest.approx([-5.0, 0.0, 7.0])
    below = ArcFactor(type="arc", title="Lamp", light="lamp", azimuth_deg=90.0, levels=(90.0,))
    assert below.baseline(TREE) is None  # it stands to the left
    assert below.applied(TREE, 90.0)["lights"]["lamp"]["position_m"] == pytest.approx([0.0, 5.0, 7.0])


def test_a_lamp_is_moved_along_its_beam() -> None:
    distance = DistanceFactor(type="distance", title="Distance", light="lamp", range=(2.5, 10.0))
    assert distance.baseline(TREE) == 5.0
    assert distance.applied(TREE, 10.0)["lights"]["lamp"]["position_m"] == pytest.approx([-6.0, 0.0, -1.0])


@pytest.mark.parametrize(
    ("light", "says"), [("sum", "did you mean 'sun'"), ("other", "axes of the target")]
)
def test_lights_that_cannot_be_moved_are_named(light: str, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        DirectionFactor(type="direction", title="x", light=light).applied(TREE, (1.0, 0.0, 0.0))
    with pytest.raises(UsageError, match="no distance"):
        DistanceFactor(type="distance", title="x", light="sun", levels=(1.0,)).baseline(TREE)
