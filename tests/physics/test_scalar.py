"""Without LLVM and GPU the same pictures come out, pixel by pixel: every branch of the kernels runs as plain Python."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from oracles.studio import box, camera, scenario, still

from renderer.photograph import Photograph, Photographer
from renderer.variant import activate
from scenes.scenario import Scenario, realize

ALONE = """
import sys, numpy as np
from renderer.photograph import Photographer
from renderer.variant import activate
from scenes.scenario import Scenario, realize
case = Scenario.model_validate_json(sys.stdin.read())
photo = Photographer(case, "cam").take(realize(case, 0, 0))
np.savez(sys.argv[1], pixels=photo.pixels, visible=photo.truth["visible_fraction"], **photo.layers)
print(activate().reason)
"""


def _case(*, polished: bool) -> Scenario:
    """A distorted, moving camera with noise before paint, coat and metal; ``polished`` needs the lobes sampled, too."""
    metal = {"type": "metal", "source": "test", "n": 1.0, "k": 6.0, "roughness": 0.02 if polished else 0.3}
    coat = {"type": "coated", "source": "test", "base_reflectance": 0.4, "roughness": 0.2}
    parts = [
        box((2.0, 2.0, 0.2)),
        box((2.0, 0.2, 1.0), metal, "shelf", centre_m=(0.0, 1.0, -0.6)),
        box((0.5, 0.5, 0.5), coat, "knob", centre_m=(-0.4, 0.2, -0.3)),
    ]
    noise = {"detector_shot_noise": True, "detector_read_noise_e": 5.0, "detector_psf_sigma_px": 0.5, "detector_prnu": 0.01}
    lens = {"distortion": (-0.2, 0.05, 1e-3, -1e-3, 0.0)}
    motion = still(6.0, (10.0, 15.0, 5.0), velocity_m_s=(3.0, 0.0, 0.0), omega_target_deg_s=(0.0, 0.0, 40.0))
    cam = camera(48, 32, 70.0, 0.02, **noise, **lens)
    return scenario(parts, cam, motion, sun={"direction": (0.5, -0.4, -1.0)}, quality="fast")


def _by_scalar(case: Scenario, folder: Path) -> tuple[dict[str, np.ndarray], str]:
    """The picture and layers from a process that finds no LLVM, and why it says it is slow."""
    environment = os.environ | {"DRJIT_LIBLLVM_PATH": "/nonexistent.so", "HARDLIGHT_CACHE": str(folder)}
    command = [sys.executable, "-c", ALONE, str(folder / "scalar.npz")]
    done = subprocess.run(
        command, input=case.model_dump_json(), env=environment, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    with np.load(folder / "scalar.npz") as stored:
        return dict(stored), done.stdout.strip()


@pytest.mark.slow
@pytest.mark.parametrize("polished", [False, True])
def test_scalar_pictures_are_the_wavefronts(polished: bool, tmp_path: Path):
    if activate().is_scalar:
        pytest.skip("nothing to compare with: this machine has no LLVM that works")
    case = _case(polished=polished)
    photo: Photograph = Photographer(case, "cam").take(realize(case, 0, 0))
    scalar, reason = _by_scalar(case, tmp_path)
    assert reason.startswith("falling back to the slow scalar_rgb, because llvm_ad_mono with /nonexistent.so: no such file")
    assert np.array_equal(scalar["part_id"], photo.layers["part_id"])
    assert np.allclose(scalar["z_m"], photo.layers["z_m"], rtol=1e-5)
    assert scalar["visible"] == photo.truth["visible_fraction"]
    # Both draw the same random numbers: what differs is the last bit of a ray that grazes an edge.
    for name in ("coverage", "unshadowed", "direct_diffuse"):
        same = np.isclose(scalar[name], photo.layers[name], rtol=1e-3, atol=1e-3 * photo.layers[name].max())
        assert same.mean() > 0.95, name
        assert scalar[name].sum() == pytest.approx(photo.layers[name].sum(), rel=2e-3), name
    specular = photo.layers["direct_specular"]
    assert specular.max() > 0
    assert scalar["direct_specular"].sum() == pytest.approx(specular.sum(), rel=0.01)
    assert np.isclose(scalar["indirect_raw"], photo.layers["indirect_raw"], rtol=1e-3).mean() > 0.9
    assert np.corrcoef(scalar["pixels"].ravel(), photo.pixels.ravel())[0, 1] > 0.999
