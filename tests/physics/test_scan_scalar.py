"""Without LLVM and GPU the same scans come out, ray by ray."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from oracles.soundings import NAME, lidar, scenario, sounding
from oracles.studio import LAMBERT, box, still

from renderer.variant import activate
from scenes.scenario import Scenario

ALONE = """
import sys, numpy as np
from renderer.ranging import Scanner
from renderer.variant import activate
from scenes.scenario import Scenario, realize
case = Scenario.model_validate_json(sys.stdin.read())
one = Scanner(case, "lidar").take(realize(case, 0, 1))
np.savez(sys.argv[1], points=one.scan.points_lidar, intensity=one.scan.intensity, **one.beams)
print(activate().reason)
"""
FLASH = {"type": "flash", "columns": 24, "rows": 16, "field_deg": (12.0, 8.0)}
RASTER = {"type": "raster", "columns": 24, "rows": 16, "field_deg": (12.0, 8.0), "scan_s": 0.8}


def _case(pattern: dict[str, object]) -> Scenario:
    """Paint, coat and metal, turning, in the sun, before a receiver that lets sunlight in."""
    metal = {"type": "metal", "source": "test", "n": 1.0, "k": 6.0, "roughness": 0.3}
    coat = {"type": "coated", "source": "test", "base_reflectance": 0.4, "roughness": 0.2}
    parts = [
        box((1.4, 1.0, 0.2), LAMBERT),
        box((1.4, 0.2, 0.6), metal, "shelf", centre_m=(0.0, 0.5, -0.4)),
        box((0.4, 0.4, 0.4), coat, "knob", centre_m=(-0.3, 0.1, -0.3)),
    ]
    noisy = {"noise_e": 20.0, "jitter_s": 1e-10, "false_alarm_probability": 0.02}
    sunny = {"filter_width_nm": 50.0, "receiver_field_mrad": 5.0}
    motion = still(9.0, (10.0, 15.0, 5.0), velocity_m_s=(0.1, 0.0, 0.2), omega_target_deg_s=(5.0, 0.0, 20.0))
    sun = {"lights": {"sun": {"type": "sun", "direction": (0.5, -0.4, -1.0)}}}
    return scenario(parts, lidar(noisy | sunny, {"divergence_mrad": 4.0}, pattern=pattern, delay_s=0.1), motion, **sun)


def _by_scalar(case: Scenario, folder: Path) -> tuple[dict[str, np.ndarray], str]:
    """The scan from a process that finds no LLVM, and why it says it is slow."""
    environment = os.environ | {"DRJIT_LIBLLVM_PATH": "/nonexistent.so", "HARDLIGHT_CACHE": str(folder)}
    command = [sys.executable, "-c", ALONE, str(folder / "scalar.npz")]
    done = subprocess.run(
        command, input=case.model_dump_json(), env=environment, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    with np.load(folder / "scalar.npz") as found:
        return dict(found), done.stdout


@pytest.mark.parametrize("pattern", [FLASH, RASTER], ids=["flash", "raster"])
def test_scalar_scans_are_the_same(pattern: dict[str, object], tmp_path: Path):
    if activate().is_scalar:
        pytest.skip("there is nothing but the scalar variant here")
    case = _case(pattern)
    scalar, reason = _by_scalar(case, tmp_path)
    assert "falling back to the slow scalar_rgb" in reason
    one = sounding(case, frame=1)
    assert scalar.keys() == {"points", "intensity", *one.beams}
    assert (one.beams["reason"] == 0).sum() > 60
    same = scalar["reason"] == one.beams["reason"]
    assert same.mean() > 0.99  # a sub-ray on an edge may go either way
    for name in ("range_m", "incidence_rad", "energy_fraction", "deskewed_m"):
        error = np.abs(scalar[name] - one.beams[name])[same]
        assert np.nanpercentile(error, 98) < 2e-3, name
    close = np.abs(scalar["electrons"] / one.beams["electrons"] - 1)[same & (one.beams["reason"] == 0)]
    assert np.percentile(close, 95) < 5e-3
    assert np.nanpercentile(np.abs(scalar["points"] - one.scan.points_lidar)[same], 95) < 5e-3
    assert case.lidars[NAME].beam.sub_rays == 7
