"""No light is made and none is lost: a white sphere, an integrating sphere, and a heap of metal."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from oracles.mitsuba_path import MitsubaPath
from oracles.studio import Studio, box, camera, direct, scenario, still, total

from renderer.quality import Preset
from scenes.spectrum import band_irradiance

WHITE = {"type": "paint", "source": "test", "reflectance": 1.0}


@pytest.mark.parametrize("phase_deg", [0.0, 60.0, 120.0])
def test_a_white_sphere_scatters_what_lambert_says(phase_deg: float):
    ball = {"name": "ball", "shape": {"type": "sphere", "radius_m": 1.0, "subdivisions": 6}, "material": WHITE}
    phase = np.radians(phase_deg)
    sun = {"direction": (np.sin(phase), 0.0, -np.cos(phase))}
    studio = Studio(scenario([ball], camera(96, 96, 80000.0), still(2000.0), sun=sun), Preset(64, 16, denoise_indirect=False))
    layers = studio.session.radiance(studio.view())
    irradiance = band_irradiance(studio.scene().lights[0].irradiance_w_m2_nm)
    intensity = direct(layers).sum() / 80000.0**2 * 2000.0**2
    by_hand = irradiance / np.pi * 2 / 3 * (np.sin(phase) + (np.pi - phase) * np.cos(phase))
    assert intensity == pytest.approx(by_hand, rel=0.004)  # a sphere of 82 000 triangles seen from 2000 radii
    assert layers["indirect"].max() == 0.0  # a convex body does not light itself
    assert layers["direct_diffuse"].max() <= irradiance / np.pi * 1.0001


@pytest.mark.parametrize("reflectance", [0.5, 0.9])
def test_an_integrating_sphere_sums_its_geometric_series(reflectance: float, tmp_path: Path):
    # Light that a Lambert wall of a sphere scatters falls evenly on the whole sphere, so every further scattering adds the
    # same radiance times q = ρ (1 − opening). Four of them are followed after the first.
    hollow, opening_radius, opening_share = _hollow_sphere(tmp_path / "hollow.stl")
    paint = WHITE | {"reflectance": reflectance}
    part = {"name": "wall", "shape": {"type": "mesh", "path": str(hollow)}, "material": paint}
    sun = {"direction": (np.sin(0.12), 0.0, -np.cos(0.12))}
    studio = Studio(scenario([part], camera(64, 64, 1200.0), still(20.0), sun=sun), Preset(64, 256, denoise_indirect=False))
    layers = studio.session.radiance(studio.view())
    lit = layers["unshadowed"] > 0
    inner = (layers["coverage"] == 1) & ~lit
    inner &= _within(inner.shape, 1200.0 * opening_radius / 21.0 - 2)
    assert inner.sum() > 300
    flux = band_irradiance(studio.scene().lights[0].irradiance_w_m2_nm) * np.pi * opening_radius**2 * np.cos(0.12)
    q = reflectance * (1 - opening_share)
    first = reflectance * flux / (4 * np.pi) * reflectance / np.pi
    assert layers["indirect"][inner].mean() == pytest.approx(first * (1 + q + q**2 + q**3), rel=0.01)


def _hollow_sphere(path: Path) -> tuple[Path, float, float]:
    """A unit sphere seen from inside, open towards −z: its file, the opening's radius and its share of the sphere."""
    sphere = trimesh.creation.icosphere(subdivisions=5, radius=1.0)
    kept = sphere.triangles_center[:, 2] > -np.cos(0.5)
    wall = trimesh.Trimesh(sphere.vertices, sphere.faces[kept][:, ::-1], process=False)
    wall.export(path)
    share = 1 - wall.area / sphere.area
    return path, float(np.sqrt(1 - (1 - 2 * share) ** 2)), float(share)


def _within(shape: tuple[int, int], radius_px: float) -> np.ndarray:
    rows, columns = np.mgrid[0 : shape[0], 0 : shape[1]]
    return np.hypot(rows - (shape[0] - 1) / 2, columns - (shape[1] - 1) / 2) < radius_px


def test_a_heap_of_metal_has_the_energy_of_mitsubas_path_tracer():
    metal = {"type": "metal", "source": "test", "n": 1.0, "k": 6.0, "roughness": 0.15}
    coat = {"type": "coated", "source": "test", "base_reflectance": 0.4, "refractive_index": 1.5, "roughness": 0.1}
    heap = [
        box((3.0, 3.0, 0.1), metal, "floor"),
        box((0.1, 3.0, 2.0), metal, "left", centre_m=(-1.5, 0.0, -1.0)),
        box((3.0, 0.1, 2.0), metal, "top", centre_m=(0.0, -1.5, -1.0)),
        box((0.8, 0.8, 0.8), coat, "cube", centre_m=(0.3, 0.4, -0.5), rotation_vector_deg=(20.0, 30.0, 10.0)),
    ]
    case = scenario(heap, camera(96, 96, 220.0), still(8.0, (10.0, 15.0, 0.0)), sun={"direction": (0.5, 0.3, -1.0)})
    studio = Studio(case, Preset(64, 64, denoise_indirect=False))
    view = studio.view()
    ours = [(direct(layers).sum(), total(layers).sum()) for layers in studio.repeats(view, range(16))]
    reference = MitsubaPath(studio, view)
    for max_depth, sums in ((2, np.array(ours)[:, 0]), (6, np.array(ours)[:, 1])):
        theirs = np.array([picture.sum() for picture in reference.radiance(max_depth, 64, range(16))])
        error = np.hypot(sums.std(ddof=1), theirs.std(ddof=1)) / 4
        assert error < 0.003 * theirs.mean()
        assert abs(sums.mean() - theirs.mean()) < 4 * error
    assert np.array(ours)[:, 1].mean() > 1.1 * np.array(ours)[:, 0].mean()  # there is indirect light to be right about


def test_more_scatterings_add_less_and_less():
    walls = [box((3.0, 3.0, 0.1), WHITE, "floor"), box((0.1, 3.0, 3.0), WHITE, "wall", centre_m=(-1.5, 0.0, -1.5))]
    case = scenario(walls, camera(64, 64, 150.0), still(8.0), sun={"direction": (0.5, 0.0, -1.0)})
    sums = []
    for scatterings in (1, 2, 3, 4, 5):
        preset = Preset(16, 256, max_scatterings=scatterings, denoise_indirect=False)
        studio = Studio(case, preset)
        sums.append(studio.session.radiance(studio.view())["indirect"].astype(float).sum())
    gains = np.diff(sums)
    assert sums[0] == 0.0
    assert (gains > 0).all()
    assert (gains[1:] < gains[:-1]).all()
    # Two white walls send less than half of their light to each other, there and back less than a quarter; the steps themselves
    # alternate, as one wall stands more in the sun than the other.
    assert (gains[2:] < 0.25 * gains[:-2]).all()
