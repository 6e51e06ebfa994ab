"""Lights as formulas, sampled in float32: cone, density and weight of a disk at every distance."""

import numpy as np
import pytest

from renderer.emitters import Kind, disk_density, disk_weight, emitter_constants, sample_light, sees_disk
from renderer.runner import _device_constants
from renderer.variant import activate
from scenes.arrays import Floats
from scenes.emitter import DistantDisk
from scenes.spectrum import BAND_NM

DIRECTION = np.array([0.35, -0.5, -0.8]) / np.linalg.norm([0.35, -0.5, -0.8])
FLAT = np.full(BAND_NM.shape, 1000.0 / 800.0)  # 1000 W/m2 from 300 to 1100 nm
HALF_ANGLES = [pytest.param(np.radians(0.2666) / au, id=f"{au} au") for au in (0.1, 1.0, 5.2, 30.0)]


@pytest.fixture(scope="module", autouse=True)
def variant() -> None:
    """Whatever renders here; these tests need a wavefront."""
    if activate().is_scalar:
        pytest.skip("no LLVM that works")


def _sun(half_angle: float) -> dict:
    import mitsuba as mi

    return _device_constants(mi, emitter_constants(DistantDisk(DIRECTION, half_angle, FLAT), np.zeros(3), np.zeros(3), 1.0))


def _samples(half_angle: float, count: int = 200_000) -> Floats:
    import drjit as dr
    import mitsuba as mi

    u = np.random.default_rng(0).random((2, count)).astype(np.float32)
    return np.array(sample_light(mi, dr, Kind(), _sun(half_angle), None, mi.Point2f(u)).direction).T.astype(np.float64)


@pytest.mark.parametrize("half_angle", HALF_ANGLES)
def test_samples_fill_the_disk_evenly(half_angle: float):
    directions = _samples(half_angle)
    assert np.abs(np.linalg.norm(directions, axis=1) - 1).max() < 3e-7
    off = directions - DIRECTION
    aside = off - (off @ DIRECTION)[:, None] * DIRECTION
    radius = np.linalg.norm(aside, axis=1) / np.sin(half_angle)
    grain = 2e-7 / half_angle  # float32 of a unit vector against the disk
    assert radius.max() < 1 + grain
    # Even by area: the squared radius is uniform.
    share = np.histogram(radius**2, bins=10, range=(0, 1))[0] / len(radius)
    assert np.abs(share - 0.1).max() < 0.004 + grain
    assert np.abs(aside.mean(axis=0)).max() < 0.005 * half_angle + 2e-8


@pytest.mark.parametrize("half_angle", HALF_ANGLES)
def test_weight_and_density_make_the_irradiance(half_angle: float):
    import drjit as dr

    sun = _sun(half_angle)
    radiance = 1000.0 / (np.pi * np.sin(half_angle) ** 2)
    solid_angle = 4 * np.pi * np.sin(half_angle / 2) ** 2
    assert float(np.array(disk_weight(sun))[0]) == pytest.approx(radiance * solid_angle, rel=1e-6)
    assert float(np.array(disk_density(dr, sun))[0]) == pytest.approx(1 / solid_angle, rel=1e-6)


@pytest.mark.parametrize("half_angle", HALF_ANGLES)
def test_a_direction_sees_the_sun_exactly_within_its_disk(half_angle: float):
    import drjit as dr
    import mitsuba as mi

    helper = np.cross(DIRECTION, [0.0, 0.0, 1.0])
    helper /= np.linalg.norm(helper)
    angles = np.linspace(0, 2, 401) * half_angle
    rays = np.cos(angles)[:, None] * DIRECTION + np.sin(angles)[:, None] * helper
    seen = np.array(sees_disk(dr, _sun(half_angle), mi.Vector3f(rays.T.astype(np.float32))))
    grain = 2e-7 / half_angle + 0.003
    assert seen[angles < half_angle * (1 - grain)].all()
    assert not seen[angles > half_angle * (1 + grain)].any()
