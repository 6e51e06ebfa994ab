"""One number per material instead of a spectrum: what a grey camera loses by it, against Mitsuba's spectral variant."""

import json
import os
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from renderer.materials import bsdf
from renderer.photometry import Photometry, photometry
from renderer.variant import activate
from scenes.material import Material, Paint
from scenes.scenario import load_scenario
from scenes.spectrum import BAND_NM, Quantity, on_band

# Incident and outgoing directions (local frame, z = normal): diffuse, near the mirror direction, and grazing.
DIRECTIONS = [((0.3, 0.1), (-0.5, 0.2)), ((0.4, 0.0), (-0.4, 0.0)), ((0.4, 0.0), (-0.36, 0.03)), ((0.85, 0.0), (-0.6, 0.6))]
SPECTRAL = """
import json, sys
import mitsuba as mi
mi.set_variant("llvm_ad_spectral")
import drjit as dr, numpy as np
job = json.load(sys.stdin)
def spectra(tree):
    if isinstance(tree, dict) and tree.get("type") == "table":
        return mi.load_dict({"type": "irregular", "wavelengths": tree["nm"], "values": tree["value"]})
    return {k: spectra(v) for k, v in tree.items()} if isinstance(tree, dict) else tree
material = mi.load_dict(spectra(job["bsdf"]))
nm = np.array(job["nm"], np.float32)
answers = []
for wi, wo in job["directions"]:
    si = dr.zeros(mi.SurfaceInteraction3f, len(nm))
    si.wi, si.wavelengths = mi.Vector3f(*wi), mi.Spectrum(mi.Float(nm))
    answers.append(np.array(material.eval(mi.BSDFContext(), si, mi.Vector3f(*wo)))[0].tolist())
print(json.dumps(answers))
"""


def _unit(xy: tuple[float, float]) -> list[float]:
    return [*xy, float(np.sqrt(1 - xy[0] ** 2 - xy[1] ** 2))]


PAIRS = [(_unit(wi), _unit(wo)) for wi, wo in DIRECTIONS]


@pytest.fixture(scope="module")
def fold() -> Photometry:
    """The paper's camera in the sun."""
    case = load_scenario("zhai2014-in-plane")
    return photometry(case.cameras["nav"], case.lights["sun"].spectrum)


def _materials() -> dict[str, Material]:
    """What the paper's target is made of."""
    return {part.name: part.material for part in load_scenario("zhai2014-in-plane").target.parts[:3]}


@pytest.mark.parametrize("part", ["body", "wing+y", "yoke+y"])
def test_the_folded_number_is_within_one_per_cent_of_the_spectral_mean(part: str, fold: Photometry):
    material = _materials()[part]
    each = _spectral(material)
    mean = np.trapezoid(each * fold.weight, BAND_NM) / np.trapezoid(fold.weight, BAND_NM)
    assert _grey(bsdf(material, fold.effective)) == pytest.approx(mean, rel=0.01)


def test_a_plain_mean_over_the_band_would_not_do(fold: Photometry):
    reddish = {"wavelength_nm": (300.0, 500.0, 600.0, 1100.0), "value": (0.05, 0.1, 0.5, 0.9)}
    paint = Paint.model_validate({"type": "paint", "source": "test", "reflectance": reddish})
    mean = np.trapezoid(_spectral(paint) * fold.weight, BAND_NM) / np.trapezoid(fold.weight, BAND_NM)
    assert _grey(bsdf(paint, fold.effective)) == pytest.approx(mean, rel=1e-4)  # one scattering off paint is linear
    flat = _grey(bsdf(paint, lambda quantity: float(on_band(quantity).mean())))
    assert np.all(flat > 1.2 * mean)


def _grey(description: dict[str, Any]) -> np.ndarray:
    activate()
    import drjit as dr
    import mitsuba as mi

    material = mi.load_dict(description)
    answers = []
    for wi, wo in PAIRS:
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.wi = mi.Vector3f(wi)
        answers.append(float(np.array(material.eval(mi.BSDFContext(), si, mi.Vector3f(wo))).ravel()[0]))
    return np.array(answers)


def _spectral(material: Material) -> np.ndarray:
    """BSDF times cosine per direction and wavelength, (n, wavelengths), from the spectral variant in its own process."""
    nm = BAND_NM.tolist()
    tables: dict[float, Quantity] = {}

    def note(quantity: Quantity) -> float:
        tables[key := -1.0 - len(tables)] = quantity
        return key

    def with_spectra(tree: Any) -> Any:
        if isinstance(tree, dict) and tree.get("type") == "uniform":
            values = on_band(tables[tree["value"]]).tolist()
            return {"type": "table", "nm": ",".join(map(str, nm)), "value": ",".join(map(str, values))}
        return {name: with_spectra(entry) for name, entry in tree.items()} if isinstance(tree, dict) else tree

    job = {"bsdf": with_spectra(bsdf(material, note)), "nm": nm, "directions": PAIRS}
    llvm = activate().llvm_path
    environment = os.environ | ({"DRJIT_LIBLLVM_PATH": llvm} if llvm else {})
    done = subprocess.run(
        [sys.executable, "-c", SPECTRAL], input=json.dumps(job), env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return np.array(json.loads(done.stdout))
