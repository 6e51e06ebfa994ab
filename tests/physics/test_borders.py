"""Where the picture ends and where triangles meet: nothing may change there that does not change on the target."""

import numpy as np
import pytest
from oracles.studio import box, camera, scenario, still

from renderer.generate import generate
from renderer.photograph import Photographer
from scenes.errors import UsageError
from scenes.scenario import Scenario, realize

AUTO = {"type": "auto", "percentile": 90.0, "target_fraction": 0.5, "longest_s": 1.0}


def photo(case: Scenario):
    return Photographer(case, "cam").take(realize(case, 0, 0))


@pytest.mark.parametrize("sigma_px", [0.5, 3.0])
def test_light_from_beside_the_picture_is_blurred_into_it(sigma_px: float):
    cam = camera(96, 64, 300.0, 1e-3, detector_psf_sigma_px=sigma_px, detector_gain_dn_per_e=0.01)
    taken = photo(scenario([box((20.0, 20.0, 0.1))], cam, still(10.0), quality="draft"))
    assert taken.layers["coverage"].min() == 1.0
    assert taken.pixels.shape == (64, 96)
    inner = float(taken.pixels[20:44, 20:76].mean())
    assert inner > 1000
    assert np.abs(taken.pixels / inner - 1).max() < 0.01  # 20 % were missing in the corners


@pytest.mark.parametrize(("width", "height"), [(201, 151), (401, 401)])
def test_no_ray_slips_through_between_triangles(width: int, height: int):
    """A cylinder seen end-on has all its caps' edges in the picture's symmetry lines; odd sizes put pixel centres there."""
    part = {"name": "can", "shape": {"type": "cylinder", "radius_m": 1.0, "height_m": 2.0}, "material": box((1, 1, 1))["material"]}
    taken = photo(scenario([part], camera(width, height, 1500.0), still(20.5), quality="draft"))
    whole = taken.layers["coverage"] == 1.0
    assert whole.sum() > 10_000
    assert (taken.layers["part_id"][whole] == 1).all()
    assert np.abs(taken.layers["z_m"][whole] - 19.5).max() < 1e-4


def test_a_target_smaller_than_a_pixel_is_not_taken_for_darkness():
    cam = camera(64, 64, 500.0, exposure=AUTO, principal_point_px=(31.3, 31.4))
    taken = photo(scenario([box((1.0, 1.0, 1.0))], cam, still(2000.0), quality="standard"))
    assert not (taken.layers["part_id"] > 0).any()
    assert taken.layers["coverage"].sum() > 0.02
    assert taken.exposure_s < 0.5


def test_a_frame_beyond_the_scenario_is_refused_before_anything_is_written(tmp_path):
    with pytest.raises(UsageError, match="the scenario has frames 0 to 0"):
        generate(scenario([box((1.0, 1.0, 1.0))], camera()), tmp_path / "out", frames=range(5, 6))
    assert not (tmp_path / "out").exists()
