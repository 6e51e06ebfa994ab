"""Edges within a beam's spot: mixed ranges in proportion to the covered area, and two returns where the step is deep enough."""

import numpy as np
import pytest
from oracles.soundings import lidar, measured_m, scenario, sounding
from oracles.studio import LAMBERT, box, still

from renderer.ranging import Scanner, Sounding
from scenes.arrays import Floats
from scenes.beam_fate import BeamFate
from scenes.scenario import Scenario, realize

DISTANCE_M, DIVERGENCE_MRAD = 20.0, 4.0
RADIUS_M = DISTANCE_M * DIVERGENCE_MRAD * 1e-3 / 2
ACROSS = {"type": "flash", "columns": 81, "rows": 1, "field_deg": (0.4, 0.01)}
RESOLUTION_M = 0.6  # c/2 · 4 ns


def _step(depth_m: float, sub_rays: int = 19, **changes: object) -> Scenario:
    """A plate at the origin that covers x < 0, and a large one ``depth_m`` behind it."""
    parts = [
        box((10.0, 10.0, 0.1), LAMBERT, "near", centre_m=(-5.0, 0.0, 0.05)),
        box((20.0, 20.0, 0.1), LAMBERT, "far", centre_m=(0.0, 0.0, 0.05 + depth_m)),
    ]
    device = lidar({}, {"divergence_mrad": DIVERGENCE_MRAD, "sub_rays": sub_rays}, pattern=ACROSS, **changes)
    return scenario(parts, device, still(DISTANCE_M))


def _places_m(case: Scenario) -> Floats:
    """Where the beams' axes cross the near plate's plane, across the edge at 0."""
    directions = case.lidars["lidar"].pattern.beams.directions_lidar[0]
    return np.asarray(DISTANCE_M * directions[:, 0] / directions[:, 2])


def _covered(case: Scenario) -> Floats:
    """Share of each round spot on the near plate: a circle's segment."""
    u = np.clip(-_places_m(case) / RADIUS_M, -1, 1)
    return np.asarray(0.5 + (u * np.sqrt(1 - u**2) + np.arcsin(u)) / np.pi)


def _electrons(one: Sounding, block: int = 0) -> Floats:
    return np.asarray(one.beams["electrons"][block], dtype=np.float64)


@pytest.mark.parametrize("depth_m", [0.1, 0.5])
def test_mixed_ranges_are_in_proportion_to_the_covered_area(depth_m: float):
    case = _step(depth_m)
    one = sounding(case)
    near_m = DISTANCE_M / case.lidars["lidar"].pattern.beams.directions_lidar[0, :, 2]
    mixed = (measured_m(one)[0] - near_m) / depth_m
    error = mixed - (1 - _covered(case))
    inside = np.abs(_places_m(case)) < RADIUS_M
    assert inside.sum() > 30
    # Nineteen rays of equal energy: a step of 1/19 each at most, twice that where two lie in line.
    assert np.abs(error[inside]).max() < 0.12
    assert np.sqrt(np.mean(error[inside] ** 2)) < 0.05
    assert np.abs(error[~inside]).max() < 0.01


def test_one_ray_mixes_nothing():
    """The control: without sub-rays every range is near or far."""
    case = _step(0.5, sub_rays=1)
    mixed = (measured_m(sounding(case))[0] - DISTANCE_M) / 0.5
    assert np.minimum(np.abs(mixed), np.abs(mixed - 1)).max() < 0.02


def test_a_step_deeper_than_the_resolution_gives_two_returns():
    case = _step(1.0, returns="strongest-and-last")
    one = sounding(case)
    covered, places = _covered(case), _places_m(case)
    assert one.scan.intensity.shape == (2, 81)
    both = np.isfinite(one.scan.intensity).all(axis=0)
    assert both[np.abs(places) < 0.6 * RADIUS_M].all()
    assert not both[np.abs(places) > 1.05 * RADIUS_M].any()
    for block in (0, 1):
        off = np.abs(measured_m(one)[block, both] - DISTANCE_M)
        assert np.minimum(off, np.abs(off - 1.0)).max() < 0.02
    near = np.abs(one.beams["range_m"][0] - DISTANCE_M) < 0.1
    near_share = np.where(near, one.beams["energy_fraction"][0], one.beams["energy_fraction"][1])
    assert np.abs(near_share - covered)[both].max() < 0.12
    assert (one.beams["energy_fraction"][:, both].sum(axis=0)) == pytest.approx(1.0)
    assert set(zip(*one.beams["reason"][:, ~both], strict=True)) == {(BeamFate.RETURN, BeamFate.NO_SECOND)}


@pytest.mark.parametrize(("depth_m", "splits"), [(0.9 * RESOLUTION_M, False), (1.1 * RESOLUTION_M, True)])
def test_returns_separate_at_the_resolution(depth_m: float, splits: bool):
    both = np.isfinite(sounding(_step(depth_m, returns="strongest-and-last")).scan.intensity).all(axis=0)
    assert both.any() == splits


@pytest.mark.parametrize(("returns", "order"), [("first", 1), ("last", -1)])
def test_first_and_last_take_the_near_and_the_far_surface(returns: str, order: int):
    case = _step(1.0, returns=returns)
    range_m = measured_m(sounding(case))[0]
    partly = np.abs(_places_m(case)) < 0.6 * RADIUS_M
    wanted = DISTANCE_M if order == 1 else DISTANCE_M + 1.0
    assert np.abs(range_m[partly] - wanted).max() < 0.02


def test_the_strongest_is_the_one_with_more_of_the_spot():
    case = _step(1.0)
    range_m, covered = measured_m(sounding(case))[0], _covered(case)
    clear = np.abs(covered - 0.5) > 0.15
    assert ((range_m < DISTANCE_M + 0.5) == (covered > 0.5))[clear].all()


def test_a_tilted_plate_stays_one_return_and_stretches_the_pulse():
    """A plate at 80 deg is 0.45 m deep within the spot; its sub-rays lie up to 0.2 m apart but no surface ends between them."""
    plate = box((20.0, 20.0, 0.2), LAMBERT, centre_m=(0.0, 0.0, 0.1))
    short = {"pulse_width_s": 0.5e-9}
    device = lidar(short, {"divergence_mrad": DIVERGENCE_MRAD, "sub_rays": 19}, pattern=ACROSS, returns="strongest-and-last")
    case = scenario([plate], device, still(DISTANCE_M, (0.0, 80.0, 0.0)))
    one = sounding(case)
    assert np.isfinite(one.scan.intensity[0]).all()
    assert np.isnan(one.scan.intensity[1]).all()
    scanner = Scanner(case, "lidar")
    echoes = scanner.echoes(realize(case, 0, 0))
    spread = echoes.range_m.std(axis=1)
    assert spread == pytest.approx(DISTANCE_M * DIVERGENCE_MRAD * 1e-3 / 4 * np.tan(np.radians(80.0)), rel=0.1)
