"""Small scenes for LIDARs: receivers without vices unless a test adds them, and scans of any frame."""

from typing import Any

import numpy as np

from oracles.studio import still
from renderer.ranging import Scanner, Sounding
from scenes.arrays import Floats
from scenes.beam_fate import BeamFate
from scenes.scenario import Scenario, realize

NAME = "lidar"
FLASH = {"type": "flash", "columns": 16, "rows": 16, "field_deg": (1.0, 1.0)}
BEAM = {"wavelength_nm": 1064.0, "divergence_mrad": 1.0, "profile": "top-hat", "sub_rays": 7}
QUIET = {
    "type": "physical",
    "pulse_energy_j": 1e-3,
    "aperture_m": 0.03,
    "transmission": 0.5,
    "quantum_efficiency": 0.4,
    "pulse_width_s": 4e-9,
    "threshold_e": 50.0,
}
PAPER = {"type": "paper", "sigma_m": 0.0}


def lidar(ranging: dict[str, Any] | None = None, beam: dict[str, Any] | None = None, **changes: Any) -> dict[str, Any]:
    """A flash of 16 × 16 pixels; ``ranging`` and ``beam`` change some of their numbers."""
    ranging = ranging or {}
    whole = ranging if ranging.get("type") == "paper" else QUIET | ranging
    return {"pattern": FLASH, "beam": BEAM | (beam or {}), "ranging": whole, "gate_m": (0.5, 1000.0)} | changes


def scenario(parts: list[dict[str, Any]], device: dict[str, Any], motion: dict[str, Any] | None = None, **changes: Any) -> Scenario:
    """One LIDAR called ``lidar`` before some parts, no light unless ``lights`` says so."""
    tree = {"frame_count": 8, "target": {"parts": parts}, "lidars": {NAME: device}, "motion": motion or still()}
    return Scenario.model_validate(tree | changes)


def sounding(case: Scenario, frame: int = 0) -> Sounding:
    """One scan with its truth."""
    return Scanner(case, NAME).take(realize(case, case.seed, frame))


def measured_m(one: Sounding) -> Floats:
    """Reported range of each beam, NaN without a return."""
    return np.asarray(np.linalg.norm(one.scan.points_lidar.astype(np.float64), axis=-1))


def share(one: Sounding, fate: BeamFate) -> float:
    """Which share of the beams that meet the target ended so."""
    reason = one.beams["reason"]
    return float(np.count_nonzero(reason == fate) / np.count_nonzero(reason != BeamFate.NOTHING))
