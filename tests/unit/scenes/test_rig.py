"""Stereo rigs: geometry against the closed form of a toed-in pair, epipolar lines, names, and what is refused."""

from typing import Any

import cv2
import numpy as np
import pytest
from pydantic import ValidationError

from scenes.dataset_manifest import calibration, rig_entry, stereo_pairs
from scenes.errors import DatasetError
from scenes.rig import StereoRig
from scenes.scenario import load_scenario

CAMERA = {
    "width_px": 2048, "height_px": 2048, "pixel_pitch_m": 5.5e-6, "focal_length_m": 1773.62 * 5.5e-6, "f_number": 4.0,
    "detector": {"quantum_efficiency": 0.5, "full_well_e": 1e4, "gain_dn_per_e": 0.02},
    "exposure": {"type": "fixed", "time_s": 1e-3},
}  # fmt: skip


def rig(**changes: Any) -> StereoRig:
    return StereoRig.model_validate({"baseline_m": 1.3, "toe_in_deg": 18.0, "camera": CAMERA} | changes)


def test_a_toed_in_pair_is_placed_as_the_closed_form_says():
    """R = Ry(2τ), t = (−B cos τ, 0, B sin τ)."""
    c, s = np.cos(np.radians(36)), np.sin(np.radians(36))
    right_from_left = rig().right_from_left
    assert right_from_left.rotation.as_matrix() == pytest.approx(np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]), abs=1e-15)
    assert right_from_left.translation == pytest.approx([-1.236373, 0, 0.401722], abs=1e-6)


def test_the_axes_cross_in_front():
    one = rig()
    left, right = (one.rig_from_cam(side) for side in ("left", "right"))
    distance = 0.65 / np.tan(np.radians(18))
    meet = [0, 0, distance]
    for side in (left, right):
        x, y, z = side.inv().apply(meet)
        assert (x, y) == pytest.approx((0, 0), abs=1e-12)
        assert z == pytest.approx(0.65 / np.sin(np.radians(18)))


@pytest.mark.parametrize("toe_in_deg", [-5.0, 0.0, 9.0, 18.0])
def test_matching_pixels_keep_the_epipolar_constraint(toe_in_deg: float):
    one = rig(toe_in_deg=toe_in_deg)
    points_left = np.random.default_rng(1).uniform([-1, -1, 3], [1, 1, 10], (500, 3))
    left = one.camera.intrinsics.project(points_left)
    right = one.camera.intrinsics.project(one.right_from_left.apply(points_left))
    lines = np.column_stack([left, np.ones(500)]) @ one.fundamental_matrix.T
    distance = np.abs(np.sum(lines * np.column_stack([right, np.ones(500)]), axis=1)) / np.linalg.norm(lines[:, :2], axis=1)
    assert distance.max() < 1e-9
    found, _ = cv2.findFundamentalMat(left, right, cv2.FM_8POINT)
    assert np.abs(found / np.linalg.norm(found)) == pytest.approx(np.abs(one.fundamental_matrix), abs=1e-6)


def test_the_sensors_are_named_after_the_rig_and_sit_where_its_mount_puts_them():
    turned = rig(mount={"position_m": (0.1, 0.2, 0.3), "rotation_vector_deg": (0, 0, 90)})
    sensors = turned.sensors("eyes")
    assert list(sensors) == ["eyes-left", "eyes-right"]
    left = sensors["eyes-left"].mount.chaser_from_cam
    assert left.translation == pytest.approx([0.1, 0.2 - 0.65, 0.3])
    right = sensors["eyes-right"].mount.chaser_from_cam
    assert (right.inv() * left).as_matrix() == pytest.approx(turned.right_from_left.as_matrix(), abs=1e-12)


def test_calibration_comes_back_from_the_manifest():
    one = rig()
    entries = {name: calibration(cam.model, rig=rig_entry(one, "eyes", name)) for name, cam in one.sensors("eyes").items()}
    (pair,) = stereo_pairs(entries).values()
    assert (pair.left, pair.right) == ("eyes-left", "eyes-right")
    assert pair.right_from_left.as_matrix() == pytest.approx(one.right_from_left.as_matrix(), abs=1e-15)
    assert np.array(entries["eyes-left"]["rig"]["fundamental_matrix"]) == pytest.approx(one.fundamental_matrix)
    assert stereo_pairs({"nav": {}}) == {}
    with pytest.raises(DatasetError, match=r"manifest\.json: it holds no stereo calibration"):
        stereo_pairs({"eyes-left": {"rig": {"name": "eyes", "left": "eyes-left", "right": "eyes-left"}}})


def test_a_rig_places_its_own_cameras():
    with pytest.raises(ValidationError, match=r"camera\.mount must be left out"):
        rig(camera=CAMERA | {"mount": {"position_m": (1, 0, 0)}})


def test_views_that_never_meet_are_refused():
    assert rig(toe_in_deg=-29.9).toe_in_deg == -29.9
    with pytest.raises(ValidationError, match="their views do not overlap anywhere"):
        rig(toe_in_deg=-30.1)


def test_the_papers_rig_is_in_the_library():
    case = load_scenario("shu2020-exp1")
    assert list(case.sensors) == ["stereo-left", "stereo-right"]
    assert case.partner("stereo-left") == "stereo-right"
    lens = case.sensors["stereo-left"].intrinsics
    assert lens.fx_px == pytest.approx(1024 / np.tan(np.radians(30)), abs=1e-4)
    assert case.rigs["stereo"].right_from_left.translation == pytest.approx([-1.236373, 0, 0.401722], abs=1e-6)
