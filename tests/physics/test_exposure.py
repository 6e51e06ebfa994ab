"""Automatic exposure brings its percentile where it should be, and says what it chose."""

import numpy as np
import pytest
from oracles.studio import box, camera, scenario, still

from renderer.photograph import Photograph, Photographer
from scenes.scenario import realize

PARTS = [
    box((2.0, 2.0, 0.5), {"type": "paint", "source": "test", "reflectance": 0.8}),
    box((2.0, 2.0, 0.5), {"type": "paint", "source": "test", "reflectance": 0.2}, "dark", centre_m=(2.1, 0.0, 0.0)),
]


def _take(rule: dict, motion: dict | None = None, **detector) -> tuple[Photograph, float]:
    """The photograph and the electrons of its rule's percentile on the target, from what it recorded."""
    settings = {"detector_full_well_e": 20000.0, "detector_gain_dn_per_e": 0.2, "detector_bits": 12, "detector_psf_sigma_px": 0.6}
    cam = camera(96, 64, 200.0, **(settings | detector)) | {"exposure": {"type": "auto"} | rule}
    case = scenario(PARTS, cam, motion or still(10.0), sun={"direction": (0.2, -0.3, -1.0)}, quality="fast")
    photographer = Photographer(case, "cam")
    photo = photographer.take(realize(case, 0, 0))
    dn = photo.pixels[photo.window.slices].astype(float)[photo.layers["part_id"] > 0]
    return photo, float(np.percentile(dn, rule.get("percentile", 95.0)))


@pytest.mark.parametrize(("percentile", "fraction"), [(95.0, 0.7), (60.0, 0.5), (20.0, 0.1)])
def test_the_percentile_reaches_its_part_of_full_scale(percentile: float, fraction: float):
    _, dn = _take({"percentile": percentile, "target_fraction": fraction})
    assert dn == pytest.approx(fraction * 0.2 * 20000.0, rel=0.005, abs=0.5)  # the well (4000 DN) ends before 4095


def test_full_scale_is_the_converter_where_that_ends_first():
    _, dn = _take({"target_fraction": 0.5}, detector_gain_dn_per_e=1.0, detector_black_level_dn=95.0)
    assert dn == pytest.approx(95.0 + 0.5 * 4000.0, rel=0.005)


@pytest.mark.parametrize(("limits", "chosen_s"), [({"longest_s": 1e-6}, 1e-6), ({"shortest_s": 0.3}, 0.3)])
def test_limits_hold(limits: dict, chosen_s: float):
    photo, _ = _take(limits)
    assert photo.exposure_s == chosen_s == photo.truth["exposure_s"]


def test_without_light_it_is_the_longest():
    cam = camera(96, 64, 200.0) | {"exposure": {"type": "auto", "longest_s": 0.25}}
    night = scenario(PARTS[:1], cam, still(10.0), sun={"direction": (0.0, 0.0, 1.0)}, quality="fast")
    photo = Photographer(night, "cam").take(realize(night, 0, 0))
    assert photo.exposure_s == 0.25
    assert photo.pixels.max() == 0


def test_a_moving_target_is_blurred_by_the_exposure_that_was_chosen():
    rule = {"target_fraction": 0.5, "longest_s": 0.02}
    slow, _ = _take(rule)
    fast, dn = _take(rule, still(10.0, velocity_m_s=(40.0, 0.0, 0.0)))
    assert fast.exposure_s == pytest.approx(slow.exposure_s, rel=0.01)
    assert dn == pytest.approx(0.5 * 4000.0, rel=0.02)
    # Truth and picture share one window, whatever was chosen: the light lies about the parts.
    columns = np.arange(fast.window.width_px)
    centres = [(layer.sum(axis=0) * columns).sum() / layer.sum() for layer in (fast.layers["coverage"], fast.layers["part_id"] > 0)]
    assert centres[0] == pytest.approx(centres[1], abs=0.2)
