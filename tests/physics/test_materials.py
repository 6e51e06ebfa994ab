"""The library's surfaces as Mitsuba evaluates them: Fresnel's formulae, layers, solar absorptance, and no energy from nowhere."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pydantic import TypeAdapter

import scenes
from renderer.materials import bsdf
from renderer.variant import activate
from scenes.arrays import Floats
from scenes.fresnel import normal_reflectance
from scenes.incandescence import tungsten_w_m2_sr_nm
from scenes.material import FilmOnMetal, Material, Metal
from scenes.scenario import load_scenario
from scenes.spectrum import BAND_NM, Quantity, band_mean, on_band

MATERIAL = TypeAdapter(Material)
NAMES = sorted(path.stem for path in (Path(scenes.__file__).parent / "library/materials").glob("*.toml"))
SHARP = 0.005  # a roughness at which shadowing among the facets no longer counts
Fold = Callable[[Quantity], float]


def library(name: str) -> Material:
    """A material by its name."""
    return load_scenario("zhai2014-in-plane", [f"target.body_material={name}"]).target.parts[0].material


def at(nm: float) -> Fold:
    """The value at one wavelength, as under a laser."""
    return lambda quantity: float(on_band(quantity)[nm == BAND_NM][0])


def in_light(weight: Floats) -> Fold:
    """The band's mean."""
    return lambda quantity: band_mean(on_band(quantity), weight)


def mirrored(material: Material, fold: Fold, angle_deg: float = 0.0) -> float:
    """Fresnel reflectance that Mitsuba uses at this incidence: in the mirror direction GGX has f·cos = F / (4π α² cos)."""
    activate()
    import drjit as dr
    import mitsuba as mi

    surface = mi.load_dict(bsdf(material.model_copy(update={"roughness": SHARP}), fold))
    si = dr.zeros(mi.SurfaceInteraction3f)
    sin, cos = math.sin(math.radians(angle_deg)), math.cos(math.radians(angle_deg))
    si.wi = mi.Vector3f(sin, 0, cos)
    value = surface.eval(mi.BSDFContext(), si, mi.Vector3f(-sin, 0, cos))
    return float(np.array(value).ravel()[0]) * 4 * np.pi * SHARP**2 * cos


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("aluminium", (0.924, 0.921, 0.912)),
        ("aluminium-brushed", (0.924, 0.921, 0.912)),
        ("mli-gold", (0.386, 0.847, 0.940)),
        ("titanium", (0.545, 0.582, 0.617)),
        ("silver", (0.918, 0.960, 0.970)),
    ],
)
def test_metals_reflect_what_their_tables_say(name: str, expected: tuple[float, ...]):
    if name == "silver":
        mirror = library("osr")
        assert isinstance(mirror, FilmOnMetal)
        metal: Material = Metal(type="metal", source="test", n=mirror.n, k=mirror.k, roughness=0.1)
    else:
        metal = library(name)
    for nm, reflectance in zip((450.0, 550.0, 650.0), expected):
        assert mirrored(metal, at(nm)) == pytest.approx(reflectance, abs=0.005)


@pytest.mark.parametrize("angle_deg", [30.0, 60.0, 75.0, 85.0])
def test_metals_follow_fresnel_at_an_angle(angle_deg: float):
    for name in ("aluminium", "mli-gold", "titanium"):
        metal = library(name)
        assert isinstance(metal, Metal)
        index = complex(at(550.0)(metal.n), at(550.0)(metal.k))
        assert mirrored(metal, at(550.0), angle_deg) == pytest.approx(np.mean(fresnel(1.0, index, angle_deg)), abs=2e-3)


def fresnel(before: complex, after: complex, angle_deg: float, first: float = 1.0) -> Floats:
    """Power reflected (s, p) where two media meet, the angle being that in a medium of index ``first`` in front of both."""
    tangential = first * np.sin(np.radians(angle_deg))
    cos_before, cos_after = (np.sqrt(1 - (tangential / n) ** 2 + 0j) for n in (before, after))
    s = (before * cos_before - after * cos_after) / (before * cos_before + after * cos_after)
    p = (after * cos_before - before * cos_after) / (after * cos_before + before * cos_after)
    return np.abs(np.array([s, p])) ** 2


def layers(film: FilmOnMetal, nm: float, angle_deg: float) -> float:
    """Reflectance of film and metal for unpolarised light at any incidence, all round trips summed one by one."""
    metal = complex(at(nm)(film.n), at(nm)(film.k))
    front, back = fresnel(1.0, film.film_index, angle_deg), fresnel(film.film_index, metal, angle_deg)
    longer = 1 / np.sqrt(1 - (np.sin(np.radians(angle_deg)) / film.film_index) ** 2)
    inside = at(nm)(film.film_transmittance) ** longer
    total, light = front.copy(), (1 - front) * inside
    for _ in range(60):
        light = light * back * inside
        total += (1 - front) * light
        light = light * front * inside
    return float(np.mean(total))


# What one conductor's lobe in the place of two layers costs at most, by angle of incidence (degrees), both films, 300-1100 nm.
MODEL_ERROR = {20.0: 0.01, 40.0: 0.025, 60.0: 0.04, 70.0: 0.065, 80.0: 0.09}


@pytest.mark.parametrize("name", ["mli-kapton", "osr"])
@pytest.mark.parametrize("nm", [400.0, 500.0, 550.0, 800.0, 1000.0])
def test_a_film_on_metal_is_its_layers(name: str, nm: float):
    film = library(name)
    assert isinstance(film, FilmOnMetal)
    assert mirrored(film, at(nm)) == pytest.approx(layers(film, nm, 0.0), abs=1e-3)
    for angle, error in MODEL_ERROR.items():
        assert mirrored(film, at(nm), angle) == pytest.approx(layers(film, nm, angle), abs=error)


def test_a_tinted_metal_would_be_too_dark_at_grazing_angles():
    """The other way to make one lobe of a film: the metal's own reflectance times a factor."""
    film = library("mli-kapton")
    assert isinstance(film, FilmOnMetal)
    bare = Metal(type="metal", source="test", n=film.n, k=film.k, roughness=0.1)
    tint = layers(film, 400.0, 0.0) / mirrored(bare, at(400.0))
    assert layers(film, 400.0, 80.0) - tint * mirrored(bare, at(400.0), 80.0) > 3 * MODEL_ERROR[80.0]


def test_an_opaque_film_is_a_dielectric():
    film = library("mli-kapton").model_copy(update={"film_transmittance": 0.0})
    for angle in (0.0, 45.0, 59.5, 80.0):  # Brewster's angle is 59.5 deg
        assert mirrored(film, at(550.0), angle) == pytest.approx(np.mean(fresnel(1.0, 1.7, angle)), abs=1e-3)


LIGHTS = {"halogen": tungsten_w_m2_sr_nm(BAND_NM, 3200.0), "sun": load_scenario("zhai2014-in-plane").lights["sun"].spectrum}


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("name", ["aluminium", "mli-gold", "mli-kapton", "titanium", "osr"])
def test_a_band_is_reflected_as_its_mean(name: str, light: str):
    weight = LIGHTS[light] * BAND_NM * _silicon()
    metal = library(name)
    assert isinstance(metal, Metal | FilmOnMetal)
    mean = band_mean(on_band(metal.reflectance), weight)
    assert mirrored(metal, in_light(weight)) == pytest.approx(mean, abs=1e-3)


def test_the_mean_of_n_and_k_would_not_do():
    weight = LIGHTS["sun"] * BAND_NM * _silicon()
    gold = library("mli-gold")
    assert isinstance(gold, Metal)
    n, k = (in_light(weight)(quantity) for quantity in (gold.n, gold.k))
    assert abs(normal_reflectance(np.array(n), np.array(k)) - band_mean(on_band(gold.reflectance), weight)) > 0.02


def _silicon() -> Floats:
    case = load_scenario("zhai2014-in-plane")
    return on_band(case.cameras["nav"].detector.quantum_efficiency)


@pytest.mark.parametrize(
    ("name", "absorptance", "within"),
    [
        ("mli-kapton", 0.40, 0.02),
        ("mli-gold", 0.225, 0.02),  # 0.19-0.30 for all wavelengths in tables of coatings
        ("osr", 0.08, 0.01),
        ("aluminium", 0.087, 0.01),
        ("white-paint", 0.26, 1e-6),
        ("black-paint", 0.95, 1e-6),
        ("marker-white", 0.22, 0.01),
        ("marker-black", 0.96, 1e-6),
    ],
)
def test_solar_absorptance_between_300_and_1100_nm(name: str, absorptance: float, within: float):
    material = library(name)
    reflectance = on_band(material.reflectance)  # type: ignore[union-attr]
    assert 1 - band_mean(reflectance, LIGHTS["sun"]) == pytest.approx(absorptance, abs=within)


def test_kapton_is_amber_and_its_thickness_is_that_of_the_table():
    film = library("mli-kapton")
    assert isinstance(film, FilmOnMetal)
    blue, green, red = (at(nm)(film.reflectance) for nm in (450.0, 550.0, 650.0))
    assert blue < 0.15
    assert 0.5 < green < red
    # Beyond 1100 nm lie 27 % of the sun's power, where aluminium behind clear film absorbs about 0.12.
    whole = 0.731 * (1 - band_mean(on_band(film.reflectance), LIGHTS["sun"])) + 0.269 * 0.12
    assert whole == pytest.approx(0.34, abs=0.02)


@pytest.mark.parametrize("name", NAMES)
def test_tables_cover_the_band_and_no_surface_makes_light(name: str):
    activate()
    import drjit as dr
    import mitsuba as mi

    material = library(name)
    for quantity in material.__dict__.values():
        if hasattr(quantity, "wavelength_nm"):
            assert quantity.wavelength_nm[0] <= 300
            assert quantity.wavelength_nm[-1] >= 1100
    surface = mi.load_dict(bsdf(material, in_light(LIGHTS["sun"])))
    count = 1 << 14
    rng = mi.PCG32(count)
    for cos in (1.0, 0.5, 0.1):
        si = dr.zeros(mi.SurfaceInteraction3f, count)
        si.wi = mi.Vector3f(math.sqrt(1 - cos**2), 0, cos)
        u = mi.Point2f(rng.next_float32(), rng.next_float32())
        _, weight = surface.sample(mi.BSDFContext(), si, rng.next_float32(), u)
        albedo = float(np.array(weight).mean())
        assert 0.0 < albedo < 1.01
