"""Rays of our own sensor in the renderer's float32 against float64 geometry."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from renderer.runner import _device_constants
from renderer.sensor import Shutter, camera_ray, lens_constants
from renderer.variant import activate
from scenes.arrays import Floats
from scenes.intrinsics import Intrinsics

LENSES = {
    "pinhole": Intrinsics(1292, 964, 2133.3, 2133.3, 645.5, 481.5),
    "barrel, 60 degrees": Intrinsics(1024, 768, 887.0, 887.0, 511.5, 383.5, (-0.3, 0.1, 0.0, 0.0, 0.0)),
    "off-centre, all terms": Intrinsics(800, 600, 640.0, 650.0, 371.0, 322.0, (-0.25, 0.08, 2e-3, -1e-3, -0.01)),
    "pincushion": Intrinsics(640, 480, 500.0, 500.0, 319.5, 239.5, (0.2, 0.05, 0.0, 0.0, 0.0)),
}


@pytest.fixture(scope="module", autouse=True)
def variant() -> None:
    """Whatever renders here; these tests need a wavefront."""
    if activate().is_scalar:
        pytest.skip("no LLVM that works")


def _rays(lens: Intrinsics, shutter: Shutter, pixels: Floats, tau: float) -> tuple[Floats, Floats, Floats]:
    import drjit as dr
    import mitsuba as mi

    constants = _device_constants(mi, lens_constants(lens) | shutter.constants)
    pixel = mi.Point2f(pixels.T.astype(np.float32))
    ray, cos_axis = camera_ray(mi, dr, constants, pixel, mi.Float(tau), distorted=lens.is_distorted)
    origin = np.broadcast_to(np.array(ray.o).T, (len(pixels), 3))
    return origin, np.array(ray.d).T, np.array(cos_axis)


def _still(pose: RigidTransform) -> Shutter:
    return Shutter.between(pose, pose, pose)


@pytest.mark.parametrize("name", LENSES)
def test_rays_go_where_the_calibration_says(name: str):
    lens = LENSES[name]
    rows, columns = np.mgrid[0 : lens.height_px : 37, 0 : lens.width_px : 41]
    corners = [(x, y) for x in (-0.5, lens.width_px - 0.5) for y in (-0.5, lens.height_px - 0.5)]
    pixels = np.concatenate([np.column_stack([columns.ravel(), rows.ravel()]), corners]).astype(float)
    pose = RigidTransform.from_components([3.0, -2.0, 50.0], Rotation.from_euler("xyz", [20, -130, 70], degrees=True))
    origin, direction, cos_axis = _rays(lens, _still(pose), pixels, 0.3)
    expected = pose.rotation.apply(lens.rays(pixels))
    assert np.abs(direction - expected).max() < 4e-7  # float32; a thousandth of a pixel
    assert np.abs(cos_axis - lens.rays(pixels)[:, 2]).max() < 2e-7
    assert np.abs(origin - pose.translation).max() < 1e-5


@pytest.mark.parametrize("turn_deg", [0.1, 3.0])
def test_a_moving_camera_is_where_a_turning_and_drifting_target_puts_it(turn_deg: float):
    axis = np.array([1.0, -2.0, 0.5]) / np.linalg.norm([1.0, -2.0, 0.5])
    start = Rotation.from_euler("xyz", [20, -130, 70], degrees=True)

    def cam_from_target(tau: float) -> RigidTransform:
        turned = start * Rotation.from_rotvec(np.radians(turn_deg) * tau * axis)
        return RigidTransform.from_components(np.array([0.5, -0.2, 40.0]) + tau * np.array([0.3, 0.1, -0.4]), turned)

    shutter = Shutter.between(*(cam_from_target(tau).inv() for tau in (-0.5, 0.0, 0.5)))
    pixels = np.array([[645.5, 481.5], [0.0, 0.0], [1291.0, 963.0]])
    for tau in (-0.5, -0.2, 0.0, 0.35, 0.5):
        pose = cam_from_target(tau).inv()
        origin, direction, _ = _rays(LENSES["pinhole"], shutter, pixels, tau)
        assert np.abs(origin - pose.translation).max() < 2e-5  # float32 at 40 m; the chord misses the arc by 14 mm
        assert np.abs(direction - pose.rotation.apply(LENSES["pinhole"].rays(pixels))).max() < 4e-7
