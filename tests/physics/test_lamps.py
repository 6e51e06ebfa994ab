"""Lamps and panels in absolute units: distance, place, beam, ripple, spectrum, several lights at once."""

from typing import Any

import numpy as np
import pytest
from oracles.studio import Studio, box, camera, direct, scenario, still, total
from scipy.integrate import quad, simpson

from renderer.quality import Preset
from scenes.arrays import Floats
from scenes.constants import BOLTZMANN_J_K, PLANCK_J_S, SPEED_OF_LIGHT_M_S
from scenes.emitter import beam_profile
from scenes.incandescence import tungsten_w_m2_sr_nm
from scenes.lamp import HalogenLamp
from scenes.material import Metal
from scenes.scenario import Scenario
from scenes.spectrum import band_irradiance, band_mean, on_band

RHO = 0.5  # of the plate that is lit
DIRECT = Preset(256, 0, denoise_indirect=False)
LAMP = {"type": "halogen", "position_m": (0.0, 0.0, 0.0), "power_w": 500.0, "radius_m": 0.02}


def _table(values: list[float]) -> dict[str, Any]:
    return {"wavelength_nm": (400.0, 500.0, 650.0, 900.0), "value": tuple(values)}


GOLD = {"type": "metal", "source": "test", "roughness": 0.3, "n": _table([1.6, 1.4, 0.3, 0.15]), "k": _table([1.9, 1.9, 3.0, 4.5])}
ALUMINIUM = GOLD | {"n": _table([0.5, 0.8, 1.4, 2.0]), "k": _table([4.9, 6.1, 7.6, 8.4])}


def _table(values: list[float]) -> dict[str, Any]:
    return {"wavelength_nm": (400.0, 500.0, 650.0, 900.0), "value": tuple(values)}


GOLD = {"type": "metal", "source": "test", "roughness": 0.3, "n": _table([1.6, 1.4, 0.3, 0.15]), "k": _table([1.9, 1.9, 3.0, 4.5])}
ALUMINIUM = GOLD | {"n": _table([0.5, 0.8, 1.4, 2.0]), "k": _table([4.9, 6.1, 7.6, 8.4])}
PLATE = box((0.2, 0.2, 0.002), centre_m=(0.0, 0.0, 0.001))


def _lit(lights: dict[str, Any], parts: list[dict[str, Any]] | None = None, **changes: Any) -> Studio:
    """A small plate 10 m before a camera that sees 40 mm of its middle, in light of our choice."""
    case = scenario(parts or [PLATE], camera(16, 16, 4000.0), still(10.0), lights=lights, **changes)
    return Studio(case, DIRECT)


def _radiance(studio: Studio) -> float:
    return float(direct(studio.session.radiance(studio.view())).mean())


@pytest.fixture(scope="module")
def by_distance() -> tuple[Floats, Floats]:
    """Distances in metres of a lamp on the plate's normal, and the plate's radiance in its light."""
    distances = np.array([2.0, 4.0, 8.0])
    lamps = ({"lamp": LAMP | {"position_m": (0.0, 0.0, 10.0 - away)}} for away in distances)
    return distances, np.array([_radiance(_lit(lamp)) for lamp in lamps])


def test_a_lamp_falls_with_the_square_of_its_distance(by_distance: tuple[Floats, Floats]):
    distances, radiance = by_distance
    assert radiance[1:] * distances[1:] ** 2 == pytest.approx(np.full(2, radiance[0] * distances[0] ** 2), rel=2e-3)


def test_a_lamp_is_as_bright_as_its_watts_say(by_distance: tuple[Floats, Floats]):
    """Against integrals of Planck's law times emissivity, and of the beam, by other rules."""
    distances, radiance = by_distance
    lamp = HalogenLamp.model_validate(LAMP)
    flux_w = 500.0 * lamp.efficiency * _tungsten(300.0, 1100.0) / _tungsten(250.0, 20_000.0)
    inner, outer = lamp.angles_rad
    spread_sr = quad(lambda t: 2 * np.pi * float(beam_profile(np.cos(t), inner, outer)) * np.cos(t) * np.sin(t), 0, np.pi / 2)[0]
    irradiance = flux_w / spread_sr / distances**2  # intensity on the axis = flux / ∫ profile cos θ dΩ
    assert radiance == pytest.approx(RHO / np.pi * irradiance, rel=3e-3)


def _tungsten(low_nm: float, high_nm: float) -> float:
    grid_nm = np.linspace(low_nm, high_nm, 40_001)
    return float(simpson(tungsten_w_m2_sr_nm(grid_nm, 3200.0), x=grid_nm))


def test_planck_keeps_wiens_and_stefans_laws():
    from scenes.incandescence import planck_w_m2_sr_nm

    grid_nm = np.geomspace(50, 1e6, 200_000)
    radiance = planck_w_m2_sr_nm(grid_nm, 3200.0)
    stefan = 2 * np.pi**5 * BOLTZMANN_J_K**4 / (15 * SPEED_OF_LIGHT_M_S**2 * PLANCK_J_S**3)
    assert np.pi * np.trapezoid(radiance, grid_nm) == pytest.approx(stefan * 3200.0**4, rel=1e-5)
    assert grid_nm[radiance.argmax()] == pytest.approx(2.897_771_955e6 / 3200.0, rel=1e-3)


def test_all_of_a_lamps_power_comes_out_of_its_beam():
    """The irradiance over a sphere around the lamp sums up to the flux that its watts leave in band."""
    case = scenario([PLATE], camera(), lights={"lamp": LAMP | {"beam_deg": 40.0, "edge_deg": 20.0}})
    emitter = Studio(case, DIRECT).scene().lights[0].emitter
    angles = np.linspace(0, np.pi / 2, 2001)
    axis, centre = emitter.normals_target[0], emitter.centres_target[0]
    aside = np.cross(axis, [1.0, 0.0, 0.0])
    places = centre + 50.0 * (np.cos(angles)[:, None] * axis + np.sin(angles)[:, None] * aside / np.linalg.norm(aside))
    irradiance = np.array([band_irradiance(emitter.irradiance_w_m2_nm(place)) for place in places])
    flux_w = np.trapezoid(irradiance * 2 * np.pi * 50.0**2 * np.sin(angles), angles)
    lamp = HalogenLamp.model_validate(LAMP)
    assert flux_w == pytest.approx(500.0 * lamp.efficiency * _tungsten(300, 1100) / _tungsten(250, 20_000), rel=2e-3)


def test_a_panel_lights_a_plate_as_its_configuration_factor_says():
    """A rectangle over a parallel element on the normal through its corner (Howell's catalogue, B-3), four of them."""
    panel = {"centre_m": (0.0, 0.0, 7.0), "facing": (0.0, 0.0, 1.0), "width_m": 2.0, "height_m": 1.2}
    studio = _lit({"room": {"type": "panels", "flux_w": 30.0, "panels": [panel]}})
    a, b = 1.0 / 3.0, 0.6 / 3.0
    corner = a / np.sqrt(1 + a * a) * np.arctan(b / np.sqrt(1 + a * a)) + b / np.sqrt(1 + b * b) * np.arctan(a / np.sqrt(1 + b * b))
    irradiance = 30.0 / (2.0 * 1.2) * 4 * corner / (2 * np.pi)  # exitance · configuration factor
    assert _radiance(studio) == pytest.approx(RHO / np.pi * irradiance, rel=3e-3)


@pytest.mark.parametrize("tilt_deg", [0.0, 30.0])
def test_the_earth_lights_a_plate_like_the_disk_that_it_is(tilt_deg: float):
    """Projected solid angle of a disk wholly above the plate's horizon: π sin²α cos(tilt)."""
    earth = {"type": "earthshine", "direction": (np.sin(np.radians(tilt_deg)), 0.0, -np.cos(np.radians(tilt_deg)))}
    studio = _lit({"earth": earth | {"altitude_m": 6.371e6}})  # at one radius up the disk's half-angle is 30°
    sun = scenario([PLATE], camera()).lights["sun"].spectrum
    irradiance = 0.3 * band_irradiance(sun) * 0.25 * np.cos(np.radians(tilt_deg))
    assert _radiance(studio) == pytest.approx(RHO / np.pi * irradiance, rel=4e-3)


@pytest.mark.parametrize("exposure_s", [1e-3, 4e-3, 7.3e-3, 10e-3, 16e-3])
def test_ripple_follows_the_integral_over_the_exposure(exposure_s: float):
    from scenes.incandescence import Ripple

    ripple = Ripple(mains_hz=50.0, depth=0.2, phase_rad=0.7)
    for time_s in (0.0, 1.2345, 3.0021):
        power = lambda t: 1 + 0.2 * np.cos(2 * np.pi * 100.0 * t + 0.7)  # noqa: E731
        mean = quad(power, time_s - exposure_s / 2, time_s + exposure_s / 2)[0] / exposure_s
        assert ripple.mean(time_s, exposure_s) == pytest.approx(mean, abs=1e-9)


@pytest.mark.parametrize(("exposure_s", "swing"), [(0.5e-3, 0.984), (4e-3, 0.757), (10e-3, 0.0)])
def test_pictures_flicker_by_as_much_as_their_exposure_lets_through(exposure_s: float, swing: float):
    """Frames at 1 s under 49.99 Hz see the whole swing; sinc(100 Hz · T) of it is left, none at 10 ms."""
    from renderer.photograph import Photographer
    from scenes.scenario import realize

    lamp = LAMP | {"position_m": (0.0, 0.0, 6.0), "mains_hz": 49.99, "ripple_depth": 0.2}
    cam = camera(16, 16, 4000.0, exposure_s, detector_full_well_e=1e12, detector_gain_dn_per_e=1e-3 / exposure_s)
    case = scenario([PLATE], cam, still(10.0), lights={"lamp": lamp}, frame_count=50, quality="draft")
    photographer = Photographer(case, "cam")
    means = np.array([photographer.take(realize(case, 0, frame)).pixels.mean() for frame in range(0, 50, 5)])
    assert means.mean() > 2000
    relative = means / means.mean() - 1
    assert np.abs(relative).max() == pytest.approx(0.2 * swing, abs=0.004)


def test_a_cooler_lamp_shifts_gold_against_aluminium_as_the_spectra_say():
    """The ratio of their electrons against reflectances weighted wavelength by wavelength with the photo-electrons."""
    ratios, expected = [], []
    for kelvin in (2400.0, 3400.0):
        lamp = {"lamp": LAMP | {"position_m": (0.0, 0.0, 6.0), "temperature_k": kelvin}}
        studios = [_lit(lamp, [PLATE | {"material": metal}]) for metal in (GOLD, ALUMINIUM)]
        gold, aluminium = (_radiance(studio) for studio in studios)
        ratios.append(gold / aluminium)
        weight = studios[0].session.photometry.weight
        expected.append(band_mean(_fresnel(GOLD), weight) / band_mean(_fresnel(ALUMINIUM), weight))
    assert ratios == pytest.approx(expected, rel=0.01)
    assert ratios[0] / ratios[1] == pytest.approx(expected[0] / expected[1], rel=0.003)
    assert ratios[0] / ratios[1] > 1.03  # warmer light favours gold


def _fresnel(metal: dict[str, Any]) -> Floats:
    """Reflectance at normal incidence on ``BAND_NM``."""
    material = Metal.model_validate(metal)
    n, k = on_band(material.n), on_band(material.k)
    return np.asarray(((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2))


def test_two_lights_make_the_sum_of_their_electrons():
    """Of different spectra, on a material with a spectrum of its own: picture of both = picture of one + picture of the other."""
    blue = {"type": "paint", "source": "test", "reflectance": _table([0.8, 0.4, 0.1, 0.05])}
    lamp, earth = LAMP | {"position_m": (-3.0, 0.0, 6.0)}, {"type": "earthshine", "direction": (0.5, 0.0, -1.0), "albedo": 0.01}
    parts = [PLATE | {"material": blue}]
    alone = [_electrons(_lit({name: light}, parts)) for name, light in (("lamp", lamp), ("earth", earth))]
    for key in ("lamp", "earth"):
        both = _lit({"lamp": lamp, "earth": earth}, parts, key_light=key)
        assert _electrons(both) == pytest.approx(sum(alone), rel=2e-3)
    assert min(alone) > 0.05 * max(alone)


def _electrons(studio: Studio) -> float:
    return float(total(studio.session.radiance(studio.view())).mean()) * studio.electrons_per_radiance


@pytest.mark.parametrize("roughness", [0.05, 0.15])
def test_light_samples_and_lobe_samples_agree_under_a_large_panel(roughness: float):
    """The mean does not depend on how the light is found (power heuristic against light samples alone)."""
    metal = {"type": "metal", "source": "test", "roughness": roughness, "n": 1.2, "k": 7.0}
    panel = {"centre_m": (0.3, -0.2, 8.0), "facing": (0.0, 0.0, 1.0), "width_m": 0.8, "height_m": 0.5}
    plate = [PLATE | {"material": metal}]
    studio = _lit({"room": {"type": "panels", "flux_w": 30.0, "panels": [panel]}}, plate)
    assert studio.session.plans[0].with_glints
    mean = np.mean([_radiance_of(studio, seed) for seed in range(4)])
    assert mean == pytest.approx(_light_samples_alone(studio), rel=0.01)


@pytest.mark.parametrize("roughness", [0.005, 0.02])
def test_panels_one_behind_the_other_add_up(roughness: float):
    """They do not hide each other, whichever way the light is found."""
    metal = {"type": "metal", "source": "test", "roughness": roughness, "n": 1.0, "k": 5.0}
    panels = [{"centre_m": (0.0, 0.0, z), "facing": (0.0, 0.0, 1.0), "width_m": 1.0, "height_m": 1.0} for z in (7.0, 6.5)]
    plate = [PLATE | {"material": metal}]
    one, other, both = (
        _radiance(_lit({"room": {"type": "panels", "flux_w": 30.0 * len(some), "panels": some}}, plate))
        for some in (panels[:1], panels[1:], panels)
    )
    assert both == pytest.approx(one + other, rel=0.01)


def _radiance_of(studio: Studio, seed: int) -> float:
    return float(direct(studio.session.radiance(studio.view(seed=seed))).mean())


def _light_samples_alone(studio: Studio) -> float:
    from dataclasses import replace

    runner = studio.session._passes[0].run
    runner.plan, runner._frozen = replace(runner.plan, with_glints=False), {}
    return float(np.mean([_radiance_of(studio, seed) for seed in range(32)]))


def test_a_lamp_that_stands_still_stays_there_while_the_shutter_is_open():
    """Blur under a near lamp is the mean of sharp pictures whose lamp keeps its place before the chaser."""
    motion = still(10.0, (0.0, 50.0, 0.0), omega_target_deg_s=(0.0, 400.0, 0.0), velocity_m_s=(20.0, 0.0, 0.0))
    lamp = {"lamp": LAMP | {"position_m": (2.0, 0.0, 8.0), "aim_m": (0.0, 0.0, 10.0), "radius_m": 0.1, "beam_deg": 100.0}}
    parts = [box((1.0, 1.0, 0.2))]
    case = scenario(parts, camera(48, 32, 250.0, 0.02), motion, lights=lamp)
    moving = Studio(case, Preset(128, 0, denoise_indirect=False), moving=True)
    view = moving.view(exposure_s=0.02)
    blurred = np.mean([direct(layers) for layers in moving.repeats(view, range(8))], axis=0)
    sharp = np.mean([_sharp(case, ((step + 0.5) / 25 - 0.5) * 0.02, step) for step in range(25)], axis=0)
    assert np.sqrt(np.mean((blurred - sharp) ** 2)) < 0.012 * sharp.max()
    assert blurred.sum() == pytest.approx(sharp.sum(), rel=3e-3)


def _sharp(case: Scenario, instant_s: float, seed: int) -> Floats:
    """The scene frozen at one instant, its lamp where it stands before the chaser."""
    import scenes.motion as motions

    pose = case.motion.chaser_from_target(instant_s, 0, 0)
    frozen = motions.Spin(
        type="spin",
        position_m=tuple(pose.translation.tolist()),
        rotation_vector_deg=tuple(pose.rotation.as_rotvec(degrees=True).tolist()),
    )
    studio = Studio(case.model_copy(update={"motion": frozen}), Preset(32, 0, denoise_indirect=False))
    view = studio.view(seed=seed)
    placed = studio.window
    from dataclasses import replace

    return direct(studio.session.radiance(replace(view, window=placed)))
