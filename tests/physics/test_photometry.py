"""Electrons of a Lambert plate in the sun against a calculation by hand, and where the scale ends."""

import math

import numpy as np
import pytest
from oracles.studio import LAMBERT, Studio, box, camera, direct, scenario, still

from renderer.masks import Light
from renderer.photograph import Photographer
from renderer.quality import Preset
from scenes.scenario import realize

DIRECT = Preset(16, 0, denoise_indirect=False)
PLANCK, LIGHT_SPEED = 6.62607015e-34, 299792458.0
# 15 nm of full-height band about 550 nm: trapezium with flanks of 5 nm.
NARROW = {"wavelength_nm": (540.0, 545.0, 555.0, 560.0), "value": (0.0, 0.6, 0.6, 0.0), "zero_outside": True}


def _plate_electrons(**changes) -> float:
    """Mean electrons of the plate that fills the picture; it must be the same in every pixel."""
    tilt, sun, cam = changes.get("tilt", (0.0, 0.0, 0.0)), changes.get("sun", {}), changes.get("cam", {})
    plate = box((60.0, 60.0, 0.1), changes.get("material", LAMBERT))
    studio = Studio(scenario([plate], camera(48, 32, **cam), still(20.0, tilt), sun=sun), DIRECT)
    electrons = direct(studio.session.radiance(studio.view())) * studio.electrons_per_radiance
    assert np.ptp(electrons) <= 0.02 * electrons.mean()  # the disk of a low sun is sampled
    return float(electrons.mean())


def test_electrons_of_a_lambert_plate_are_those_of_a_hand_calculation():
    # ASTM E490-00a at 550 nm: 1.863 W m⁻² nm⁻¹. The plate is tilted by 40° about x, the sun stands 30° above the boresight.
    tilt_deg, sun_deg = 40.0, 30.0
    cos_incidence = math.cos(math.radians(tilt_deg - sun_deg))
    photons_per_joule = 550e-9 / (PLANCK * LIGHT_SPEED)
    electrons_per_s_m2 = 1.863 * 15.0 * 0.6 * photons_per_joule  # at normal incidence, behind a perfect lens
    radiance_share = 0.5 * cos_incidence / math.pi  # Lambert: L = ρ E cos θ / π
    lens = math.pi * 0.9 / (4 * 4.0**2)  # E' = L π τ / (4 N²)
    by_hand = electrons_per_s_m2 * radiance_share * lens * (5e-6) ** 2 * 1e-3
    sun = {"direction": (0.0, -math.sin(math.radians(sun_deg)), -math.cos(math.radians(sun_deg)))}
    cam = {"transmission": 0.9, "detector_quantum_efficiency": NARROW}
    # Camera axes have y down: a turn by −40° about x lifts the plate's normal (0, 0, −1) towards the sun above.
    rendered = _plate_electrons(tilt=(-tilt_deg, 0.0, 0.0), sun=sun, cam=cam)
    assert rendered == pytest.approx(by_hand, rel=0.002)  # the promise is 0.005
    control = _plate_electrons(tilt=(tilt_deg, 0.0, 0.0), sun=sun, cam=cam)
    assert control == pytest.approx(by_hand * math.cos(math.radians(70.0)) / cos_incidence, rel=0.002)


def test_a_wide_band_counts_photons_not_joules():
    # Flat efficiency 0.5 from 300 to 1100 nm: ∫ E λ dλ / (hc), summed in steps of 1 nm over E490-00a's values at 100 nm.
    nodes_nm = np.arange(300.0, 1101.0, 20.0)
    studio_sun = scenario([box((1, 1, 1))], camera()).lights["sun"]
    table = np.interp(nodes_nm, np.arange(300.0, 1101.0, 5.0), studio_sun.spectrum)
    known = {400: 1.419, 500: 1.930, 600: 1.771, 700: 1.415, 800: 1.132, 900: 0.926, 1000: 0.744, 1100: 0.594}
    assert {nm: round(float(table[nodes_nm == nm][0]), 3) for nm in known} == known
    fine_nm = np.arange(300.0, 1100.5, 1.0)
    photons = np.sum(np.interp(fine_nm, nodes_nm, table) * fine_nm * 1e-9) / (PLANCK * LIGHT_SPEED)
    by_hand = photons * 0.5 * 0.5 / math.pi * math.pi / (4 * 4.0**2) * (5e-6) ** 2 * 1e-3
    assert _plate_electrons() == pytest.approx(by_hand, rel=0.002)


def test_a_sun_twice_as_far_gives_a_quarter():
    near = _plate_electrons(sun={"distance_au": 1.0})
    assert _plate_electrons(sun={"distance_au": 2.0}) == pytest.approx(near / 4, rel=1e-4)
    # At 30 au the disk's cosine is 1 in float32: the far sun must still be a sun.
    assert _plate_electrons(sun={"distance_au": 30.0}) == pytest.approx(near / 900, rel=1e-4)


def test_a_spectral_paint_counts_where_the_camera_sees():
    edge = {"wavelength_nm": (300.0, 549.0, 551.0, 1100.0), "value": (0.0, 0.0, 1.0, 1.0)}
    paint = {"type": "paint", "source": "test", "reflectance": edge}
    cam = {"detector_quantum_efficiency": NARROW}
    white = _plate_electrons(material=LAMBERT | {"reflectance": 1.0}, cam=cam)
    assert _plate_electrons(material=paint, cam=cam) == pytest.approx(white / 2, rel=0.02)
    below = {"detector_quantum_efficiency": NARROW | {"wavelength_nm": (500.0, 505.0, 515.0, 520.0)}}
    assert _plate_electrons(material=paint, cam=below) == 0.0


def test_a_materials_number_is_weighted_with_photons():
    # ρ rises linearly over the band; per joule instead of per photon the answer would be 7 % less.
    rising = {"wavelength_nm": (300.0, 1100.0), "value": (0.0, 1.0)}
    paint = {"type": "paint", "source": "test", "reflectance": rising}
    nm = np.arange(300.0, 1101.0, 5.0)
    sun = scenario([box((1, 1, 1))], camera()).lights["sun"].spectrum
    by_hand = np.sum(sun * nm * (nm - 300) / 800) / np.sum(sun * nm)
    assert np.sum(sun * (nm - 300) / 800) / np.sum(sun) < 0.95 * by_hand
    white = _plate_electrons(material=LAMBERT | {"reflectance": 1.0})
    assert _plate_electrons(material=paint) / white == pytest.approx(by_hand, rel=0.003)


@pytest.mark.parametrize(
    ("bits", "gain", "full_well_e", "plateau_dn"),
    [
        pytest.param(12, 0.5, 2000.0, 16 + 0.5 * 2000.0, id="the full well ends first"),
        pytest.param(12, 0.5, 1e5, 4095.0, id="the 12-bit converter ends first"),
        pytest.param(8, 0.05, 1e5, 255.0, id="the 8-bit converter ends first"),
    ],
)
def test_saturation_is_where_well_or_converter_end(bits: int, gain: float, full_well_e: float, plateau_dn: float):
    detector = {"detector_bits": bits, "detector_gain_dn_per_e": gain, "detector_full_well_e": full_well_e}
    noise = {"detector_black_level_dn": 16.0, "detector_shot_noise": True, "detector_read_noise_e": 2.0}
    cam = camera(48, 32, exposure_s=1.0, **detector, **noise)
    taken = {}
    for exposure_s in (2e-6, 1.0):
        cam["exposure"] = {"type": "fixed", "time_s": exposure_s}
        case = scenario([box((60.0, 60.0, 0.1))], cam, still(20.0), quality="draft")
        taken[exposure_s] = Photographer(case, "cam").take(realize(case, 0, 0))
    bright, dim = taken[1.0], taken[2e-6]
    assert bright.pixels.mean() == pytest.approx(plateau_dn, abs=0.1)
    assert bright.pixels.dtype == (np.uint8 if bits == 8 else np.uint16)
    assert (bright.layers["mask"] & Light.SATURATED).all()
    assert bright.truth["saturated_fraction"] == 1.0
    assert not (dim.layers["mask"] & Light.SATURATED).any()
    assert 16 < dim.pixels.mean() < plateau_dn
