"""The EMVA 1288 model pixel by pixel; whole photon-transfer measurements are in tests/physics."""

from typing import Any

import numpy as np
import pytest
from scipy import stats

from renderer.detection import _dark_charge, detect, exposure_time_s, fixed_pattern, full_scale_e
from scenes.camera import Camera
from scenes.exr import Window


def _camera(width: int = 32, height: int = 24, exposure: dict[str, Any] | None = None, **detector: Any) -> Camera:
    body = {"quantum_efficiency": 0.5, "full_well_e": 1e4, "gain_dn_per_e": 0.1, "bits": 12, "shot_noise": False} | detector
    return Camera.model_validate(
        {
            "width_px": width,
            "height_px": height,
            "pixel_pitch_m": 5e-6,
            "focal_length_m": 0.01,
            "f_number": 4,
            "detector": body,
            "exposure": exposure or {"type": "fixed", "time_s": 0.1},
        }
    )


def _picture(camera: Camera, electrons: Any, window: Window | None = None, seed: int = 0, time_s: float = 0.1) -> np.ndarray:
    everywhere = window or Window(0, 0, camera.width_px, camera.height_px)
    field = np.broadcast_to(np.float32(electrons), (everywhere.height_px, everywhere.width_px))
    pattern = fixed_pattern(camera, "cam", 0)
    return detect(field, everywhere, camera, time_s, pattern, np.random.default_rng(seed))


@pytest.mark.parametrize(
    ("electrons", "dn"),
    [
        pytest.param(0.0, 20, id="dark: black level"),
        pytest.param(1000.0, 120, id="gain"),
        pytest.param(1004.9, 120, id="rounds down"),
        pytest.param(1005.0, 121, id="half rounds up"),
        pytest.param(1e9, 1020, id="full well"),
    ],
)
def test_without_noise_the_number_is_exact(electrons: float, dn: int):
    picture = _picture(_camera(black_level_dn=20.0), electrons)
    assert picture.dtype == np.uint16
    assert (picture == dn).all()


@pytest.mark.parametrize(
    ("bits", "white", "kind"), [(1, 1, np.uint8), (8, 255, np.uint8), (9, 511, np.uint16), (16, 65535, np.uint16)]
)
def test_the_converter_ends_at_its_bits(bits: int, white: int, kind: type):
    picture = _picture(_camera(bits=bits, full_well_e=1e9, gain_dn_per_e=1.0), 1e8)
    assert picture.dtype == kind
    assert (picture == white).all()


def test_noise_does_not_wrap_around_at_zero():
    picture = _picture(_camera(bits=8, read_noise_e=300.0), 0.0)
    assert picture.min() == 0
    assert picture.max() < 200
    assert (picture == 0).mean() == pytest.approx(0.5, abs=0.05)


def test_a_window_lies_in_the_dark():
    window = Window(5, 7, 4, 3)
    picture = _picture(_camera(), 1000.0, window)
    assert (picture[window.slices] == 100).all()
    assert picture.sum() == 100 * 12


def test_dark_current_fills_the_whole_picture_in_proportion_to_time():
    camera = _camera(dark_current_e_s=500.0)
    assert (_picture(camera, 0.0, time_s=2.0) == 100).all()
    assert (_picture(camera, 200.0, Window(1, 1, 2, 2), time_s=2.0)[1:3, 1:3] == 120).all()


def test_shot_noise_is_poisson():
    camera = _camera(200, 200, shot_noise=True, gain_dn_per_e=1.0, bits=16)
    charge = _picture(camera, 9.0).ravel()
    counts = np.bincount(charge, minlength=31)[:31]
    expected = stats.poisson.pmf(np.arange(31), 9.0) * charge.size
    keep = expected > 5
    chi2 = ((counts - expected)[keep] ** 2 / expected[keep]).sum()
    assert stats.chi2.sf(chi2, keep.sum()) > 1e-3


@pytest.mark.parametrize("mean_e", [0.002, 0.05, 0.0999, 0.3])
def test_strewn_dark_electrons_are_distributed_like_drawn_ones(mean_e: float):
    rng = np.random.default_rng(3)
    strewn = np.concatenate([_dark_charge((300, 400), mean_e, rng).ravel() for _ in range(20)])
    counts = np.bincount(strewn.astype(int), minlength=8)[:8]
    expected = stats.poisson.pmf(np.arange(8), mean_e) * strewn.size
    keep = expected > 5
    chi2 = ((counts - expected)[keep] ** 2 / expected[keep]).sum()
    assert stats.chi2.sf(chi2, keep.sum() - 1) > 1e-3
    # Independent between neighbours, and the totals of whole pictures scatter like a Poisson number, too.
    pairs = strewn.reshape(-1, 2)
    assert abs(np.corrcoef(pairs.T)[0, 1]) < 4 / np.sqrt(len(pairs))
    totals = strewn.reshape(20, -1).sum(axis=1)
    assert stats.chi2.cdf(totals.var(ddof=1) * 19 / (mean_e * 120000), 19) == pytest.approx(0.5, abs=0.499)


def test_fixed_patterns_belong_to_camera_and_seed():
    camera = _camera(256, 192, prnu=0.02, dsnu_e=4.0)
    pattern, again = fixed_pattern(camera, "left", 7), fixed_pattern(camera, "left", 7)
    assert np.array_equal(pattern.gain, again.gain)
    assert np.array_equal(pattern.offset_e, again.offset_e)
    for other in (fixed_pattern(camera, "right", 7), fixed_pattern(camera, "left", 8)):
        assert abs(np.corrcoef(pattern.gain.ravel(), other.gain.ravel())[0, 1]) < 0.02
    assert abs(np.corrcoef(pattern.gain.ravel(), pattern.offset_e.ravel())[0, 1]) < 0.02
    assert pattern.gain.mean() == pytest.approx(1.0, abs=5e-4)
    assert pattern.gain.std() == pytest.approx(0.02, rel=0.02)
    assert pattern.offset_e.std() == pytest.approx(4.0, rel=0.02)


def test_prnu_scales_light_and_not_the_dark():
    camera = _camera(64, 64, prnu=0.1, gain_dn_per_e=1.0, bits=16, dark_current_e_s=1000.0)
    assert np.ptp(_picture(camera, 0.0, time_s=1.0)) == 0
    bright = _picture(camera, 2000.0, time_s=1.0).astype(float) - 1000
    assert bright.std() == pytest.approx(200.0, rel=0.05)


@pytest.mark.parametrize(
    ("detector", "full_scale"),
    [({"full_well_e": 5000.0}, 5000.0), ({"full_well_e": 1e6, "black_level_dn": 95.0}, 40000.0)],
)
def test_full_scale_is_what_ends_first(detector: dict[str, float], full_scale: float):
    assert full_scale_e(_camera(**detector).detector) == full_scale


def test_exposure_goes_by_the_target_alone():
    camera = _camera(exposure={"type": "auto", "percentile": 50.0, "target_fraction": 0.5, "longest_s": 10.0})
    rate = np.full((24, 32), 1e9, np.float32)
    on_target = np.zeros((24, 32), bool)
    on_target[3:9, 4:8] = True
    rate[on_target] = 2000.0
    assert exposure_time_s(camera, rate, on_target) == pytest.approx(2.5)
    assert exposure_time_s(camera, rate * 0, on_target) == 10.0
    assert exposure_time_s(camera, rate, ~on_target & on_target) == 10.0
    assert exposure_time_s(_camera(), rate, on_target) == 0.1
