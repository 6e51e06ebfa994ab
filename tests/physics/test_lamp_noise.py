"""Under the halogen lamp: noise at ``standard`` against the sensor's own, and the energy against Mitsuba's own path tracer."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from oracles.mitsuba_path import MitsubaPath
from oracles.studio import Studio, direct, total

from renderer.session import View
from scenes.arrays import Bools, Floats
from scenes.emitter import Patches
from scenes.exr import Window
from scenes.scenario import load_scenario
from scenes.spectrum import band_irradiance

SEEDS = range(64)
PART = Window(400, 790, 160, 160)  # the ring's lit side, foil, a marker, the ring's shadow


@dataclass(frozen=True)
class Repeats:
    """A studio, its view, and mean and standard deviation of each layer in electrons, (h, w)."""

    studio: Studio
    view: View
    mean: dict[str, Floats]
    sigma: dict[str, Floats]
    saturated: Bools


@pytest.fixture(scope="module")
def repeats() -> Repeats:
    """64 seeds of a part of the first picture of experiment 3, lit by a lamp whose beam is wider than the target."""
    case = load_scenario("shu2020-exp3", ["lights.lamp.beam_deg=150.0", "lights.lamp.power_w=4700.0"])
    studio = Studio(case, size=(PART.width_px, PART.height_px))
    view = replace(studio.view(), window=PART)
    stacks: dict[str, list[Floats]] = {"direct": [], "total": []}
    for layers in studio.repeats(view, SEEDS):
        stacks["direct"].append(direct(layers) * studio.electrons_per_radiance)
        stacks["total"].append(total(layers) * studio.electrons_per_radiance)
    mean = {name: np.mean(stack, axis=0) for name, stack in stacks.items()}
    sigma = {name: np.std(stack, axis=0, ddof=1) for name, stack in stacks.items()}
    detector = studio.camera.detector
    return Repeats(studio, view, mean, sigma, mean["total"] > detector.full_well_e)


@pytest.mark.slow
def test_direct_light_is_quieter_than_a_third_of_the_sensor(repeats: Repeats):
    detector = repeats.studio.camera.detector
    electrons = repeats.mean["total"]
    sensor_e = np.sqrt(electrons + detector.read_noise_e**2 + (detector.prnu * electrons) ** 2)
    share = (repeats.sigma["direct"] / sensor_e)[~repeats.saturated]
    print(f"direct light below a third of the sensor's noise: {100 * np.mean(share < 1 / 3):.1f} % of {share.size} pixels")
    assert np.mean(share < 1 / 3) > 0.90
    assert 500 < np.median(electrons) < detector.full_well_e


@pytest.mark.slow
@pytest.mark.parametrize(("layer", "max_depth", "samples"), [("direct", 2, 64), ("total", 6, 512)])
def test_energy_is_that_of_mitsubas_own_path_tracer(repeats: Repeats, layer: str, max_depth: int, samples: int):
    reference = MitsubaPath(repeats.studio, repeats.view, emitter=_disk)
    pictures = np.array(list(reference.radiance(max_depth, samples, range(8)))) * repeats.studio.electrons_per_radiance
    sums = pictures.sum(axis=(1, 2))
    relative_error = float(sums.std(ddof=1) / np.sqrt(len(sums)) / sums.mean())
    ratio = float(repeats.mean[layer].sum() / sums.mean())
    print(f"{layer}: {ratio:.5f} ± {relative_error:.5f} of the path tracer's energy")
    assert relative_error < 1e-3
    assert abs(ratio - 1) < 0.005


def _disk(mi: Any, view: View) -> dict[str, Any]:
    """The lamp's aperture as an area emitter of Mitsuba's."""
    lamp = view.lights[0].emitter
    assert isinstance(lamp, Patches)
    place, normal = lamp.centres_target[0], lamp.normals_target[0]
    up = [0.0, 0.0, 1.0] if abs(normal[2]) < 0.9 else [1.0, 0.0, 0.0]
    frame = mi.ScalarTransform4f().look_at(origin=place.tolist(), target=(place + normal).tolist(), up=up)
    radius = float(np.linalg.norm(lamp.u_target[0]))
    radiance = {"type": "uniform", "value": band_irradiance(lamp.radiance_w_m2_sr_nm)}
    return {"type": "disk", "to_world": frame.scale(radius), "emitter": {"type": "area", "radiance": radiance}}
