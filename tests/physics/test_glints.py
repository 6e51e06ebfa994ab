"""The sun in polished metal: radiance against the microfacet formula, integrated over the sun's disk in numpy."""

import numpy as np
import pytest
from oracles.studio import Studio, box, camera, scenario, still

from renderer.quality import Preset
from scenes.arrays import Floats
from scenes.spectrum import band_irradiance

N, K = 1.0, 6.0
HALF_ANGLE = np.radians(0.2666)
F_PX, SIZE = 1500.0, 64


def _plate(roughness: float, samples: int = 256) -> Studio:
    metal = {"type": "metal", "source": "test", "n": N, "k": K, "roughness": roughness}
    # The sun stands 1° off the boresight, the plate is turned by 0.5°: its image falls on the picture's centre.
    sun = {"direction": (np.sin(np.radians(1.0)), 0.0, -np.cos(np.radians(1.0)))}
    case = scenario([box((20.0, 20.0, 0.1), metal)], camera(SIZE, SIZE, F_PX), still(50.0, (0.0, -0.5, 0.0)), sun=sun)
    return Studio(case, Preset(samples, 0, denoise_indirect=False))


def _expected(studio: Studio, roughness: float) -> Floats:
    """Radiance (h, w) of GGX with Smith's masking and exact conductor Fresnel, averaged over each pixel and the disk."""
    light = studio.scene().lights[0]
    radiance = band_irradiance(light.irradiance_w_m2_nm) / (np.pi * np.sin(light.emitter.half_angle_rad) ** 2)
    sun = _disk(light.direction_target, light.emitter.half_angle_rad)
    solid_angle = 2 * np.pi * (1 - np.cos(light.emitter.half_angle_rad)) / len(sun)
    offsets = (np.arange(4) - 1.5) / 4
    total = np.zeros((SIZE, SIZE))
    rows, columns = np.mgrid[0:SIZE, 0:SIZE].astype(float)
    target_from_cam = studio.cam_from_target().inv().rotation
    for dx in offsets:
        for dy in offsets:
            sight = studio.camera.intrinsics.rays(np.stack([columns + dx, rows + dy], axis=-1).reshape(-1, 2))
            away = -target_from_cam.apply(sight)
            total += np.concatenate([_ggx(chunk, sun, roughness) for chunk in np.array_split(away, 8)]).reshape(SIZE, SIZE)
    return total * radiance * solid_angle / 16


def _ggx(wo: Floats, wi: Floats, alpha: float) -> Floats:
    """Σ over wi of f · cos θ_i for directions wo (n, 3), normal (0, 0, −1) (Walter et al. 2007, eqs. 20, 33, 34)."""
    half = wo[:, None] + wi[None]
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    cos_h = -half[..., 2]
    tan2 = 1 / cos_h**2 - 1
    density = 1 / (np.pi * alpha**2 * cos_h**4 * (1 + tan2 / alpha**2) ** 2)
    cos_i, cos_o = -wi[:, 2], -wo[:, 2]
    masking = _smith(cos_i, alpha)[None] * _smith(cos_o, alpha)[:, None]
    fresnel = ((N - 1) ** 2 + K**2) / ((N + 1) ** 2 + K**2)  # within 1.5° of normal incidence
    return (density * masking).sum(axis=1) * fresnel / (4 * cos_o)


def _smith(cos: Floats, alpha: float) -> Floats:
    return 2 / (1 + np.sqrt(1 + alpha**2 * (1 / cos**2 - 1)))


def _disk(direction: Floats, half_angle: float, rings: int = 12) -> Floats:
    """Directions that share the disk evenly by solid angle."""
    helper = np.cross(direction, [0.0, 1.0, 0.0])
    e1 = helper / np.linalg.norm(helper)
    e2 = np.cross(direction, e1)
    golden = np.pi * (3 - np.sqrt(5))
    count = rings**2 * 3
    index = np.arange(count)
    versine = (index + 0.5) / count * (1 - np.cos(half_angle))
    sin = np.sqrt(versine * (2 - versine))
    around = np.cos(index * golden)[:, None] * e1 + np.sin(index * golden)[:, None] * e2
    return (1 - versine)[:, None] * direction + sin[:, None] * around


@pytest.mark.parametrize(
    "roughness",
    [
        pytest.param(0.002, id="narrower than the sun: found by the lobe"),
        pytest.param(0.005, id="as wide as the sun: found by both"),
        pytest.param(0.02, id="wider"),
        pytest.param(0.06, id="sampled by the light alone"),
    ],
)
def test_the_suns_image_in_metal_has_the_right_radiance(roughness: float):
    studio = _plate(roughness)
    rendered = np.mean([layers["direct_specular"] for layers in studio.repeats(studio.view(), range(4))], axis=0)
    expected = _expected(studio, roughness)
    assert rendered.sum() == pytest.approx(expected.sum(), rel=0.002)  # measured: 4e-4 at worst
    bright = expected > 0.2 * expected.max()
    assert rendered[bright].sum() == pytest.approx(expected[bright].sum(), rel=0.003)
    assert np.sqrt(np.mean((rendered[bright] - expected[bright]) ** 2)) < 0.015 * expected.max()
    centre = np.unravel_index(expected.argmax(), expected.shape)
    assert np.hypot(centre[0] - 31.5, centre[1] - 31.5) < 3


def test_all_the_light_that_a_mirror_gets_leaves_it():
    # α = 0.001: 99.7 % of the lobe ends within the picture, and there is no other place for the light to go.
    studio = _plate(0.001)
    layers = studio.session.radiance(studio.view())
    irradiance = band_irradiance(studio.scene().lights[0].irradiance_w_m2_nm)
    fresnel = ((N - 1) ** 2 + K**2) / ((N + 1) ** 2 + K**2)
    reflected = layers["direct_specular"].astype(float).sum() / F_PX**2
    assert 0.985 * irradiance * fresnel < reflected < 1.003 * irradiance * fresnel
    assert (layers["direct_diffuse"] == 0).all()


def test_sampling_the_lobe_quietens_a_near_mirror():
    studio = _plate(0.002, samples=16)
    assert studio.session.plans[0].with_glints
    stack = np.array([layers["direct_specular"] for layers in studio.repeats(studio.view(), range(16))])
    bright = stack.mean(axis=0) > 0.2 * stack.mean(axis=0).max()
    # Light samples alone leave 0.235 of the mean at 16 samples, and there is no saying what at α = 0.001.
    assert np.mean(stack.std(axis=0, ddof=1)[bright] / stack.mean(axis=0)[bright]) < 0.21
