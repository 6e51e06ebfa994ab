import math

import numpy as np
import pytest
from pydantic import ValidationError

from scenes.camera import Camera, Mount
from scenes.scenario import load_scenario

BODY = {
    "width_px": 640,
    "height_px": 480,
    "pixel_pitch_m": 5e-6,
    "focal_length_m": 0.0025,
    "f_number": 4.0,
    "detector": {"quantum_efficiency": 0.5, "full_well_e": 1e4, "gain_dn_per_e": 0.1},
    "exposure": {"type": "fixed", "time_s": 1e-3},
}


def _camera(**changes) -> Camera:
    return Camera.model_validate(BODY | changes)


def test_the_papers_camera_has_the_papers_geometry():
    lens = load_scenario("zhai2014-in-plane").cameras["nav"].intrinsics
    assert lens.fx_px == pytest.approx(2133.333, abs=1e-3)
    assert lens.fy_px == lens.fx_px
    assert (lens.cx_px, lens.cy_px) == (645.5, 481.5)
    field = [2 * math.degrees(math.atan(edge / 2 / lens.fx_px)) for edge in (1292, 964)]
    assert field == pytest.approx([33.70, 25.46], abs=0.01)


def test_the_principal_point_is_the_centre_unless_given():
    assert (_camera().intrinsics.cx_px, _camera().intrinsics.cy_px) == (319.5, 239.5)
    corner = _camera(principal_point_px=(0.0, 0.0)).intrinsics
    assert (corner.cx_px, corner.cy_px) == (0.0, 0.0)


def test_the_etendue_is_the_camera_equations():
    assert _camera(transmission=0.8).pixel_solid_etendue_m2_sr == pytest.approx(25e-12 * math.pi * 0.8 / 64)


def test_a_mount_takes_camera_points_into_chaser_axes():
    mount = Mount(position_m=(1.0, 2.0, 3.0), rotation_vector_deg=(0.0, 90.0, 0.0))
    # A turn by +90° about y sends the boresight z to x.
    assert mount.chaser_from_cam.apply([0.0, 0.0, 5.0]) == pytest.approx([6.0, 2.0, 3.0])
    assert np.allclose(Mount().chaser_from_cam.as_matrix(), np.eye(4))


def test_a_lens_that_would_fold_its_own_picture_is_refused():
    # f = 500 px: k1 = −1 folds at r = 0.577, imaged at 192 px; the corner lies at 399 px.
    with pytest.raises(
        ValidationError, match="folds the image 192 px from the principal point, but the picture's corner lies at 399 px"
    ):
        _camera(distortion=(-1.0, 0.0, 0.0, 0.0, 0.0))
    assert _camera(distortion=(-0.2, 0.0, 0.0, 0.0, 0.0)).intrinsics.is_distorted


@pytest.mark.parametrize(
    "changes",
    [{"width_px": 0}, {"f_number": -1}, {"focal_length_m": 0}, {"transmission": 1.2}, {"pixel_pitch_m": float("nan")}, {"fx": 3}],
)
def test_impossible_cameras_are_refused(changes: dict):
    with pytest.raises(ValidationError):
        _camera(**changes)


def test_estimators_are_told_calibration_and_scale():
    model = _camera(detector=BODY["detector"] | {"bits": 12, "black_level_dn": 64.0}).model
    assert (model.black_dn, model.white_dn) == (64.0, 4095.0)
    assert model.intrinsics == _camera().intrinsics
