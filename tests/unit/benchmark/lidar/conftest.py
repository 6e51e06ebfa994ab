"""Small LIDAR data sets of a tumbling body with hand-made truth, and answers to them with errors of a known covariance."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.filter_truth import mass_of
from benchmark.predictions import COLUMNS, Predictions
from benchmark.records import KnowledgeRecord, ModelRecord, RunRecord
from scenes.beam_fate import BeamFate
from scenes.dataset import Dataset
from scenes.dataset_layout import TRUTH_COLUMNS
from scenes.dataset_lidar import lidar_entry
from scenes.dataset_manifest import Manifest
from scenes.dataset_writer import DatasetWriter, FrameRecord
from scenes.inertia import components_of
from scenes.lidar import Lidar
from scenes.pose_columns import pose_columns
from scenes.recording import Scan
from scenes.target import Target

SIZE = 24
LIDAR = Lidar.model_validate(
    {
        "pattern": {"type": "flash", "columns": SIZE, "rows": SIZE, "field_deg": [8.0, 8.0]},
        "beam": {"wavelength_nm": 1064.0, "divergence_mrad": 1.0},
        "ranging": {"type": "paper", "sigma_m": 0.05, "edge_sigma_m": 0.1, "cutoff_deg": 75.0, "cutoff_width_deg": 3.0},
        "gate_m": [1.0, 150.0],
        "delay_s": 0.05,
    }
)
_GREY = {"type": "paint", "reflectance": 0.5, "source": "made up"}
BODY_FROM = (0.2, -0.1, 0.4)  # the centre of mass, target frame
TARGET = {
    "type": "assembly",
    "parts": [
        {"name": "body", "shape": {"type": "box", "size_m": [2.0, 1.6, 1.2]}, "material": _GREY},
        {"name": "panel", "shape": {"type": "box", "size_m": [0.1, 4.0, 1.0]}, "material": _GREY, "centre_m": [0.0, 2.9, 0.0]},
        {"name": "inside", "shape": {"type": "box", "size_m": [0.5, 0.5, 0.5]}, "material": _GREY},
    ],
    "mass": {
        "principal_kg_m2": [500.0, 1000.0, 1300.0],
        "centre_of_mass_m": list(BODY_FROM),
        "quaternion_wxyz": (Rotation.from_euler("xyz", [30.0, -20.0, 70.0], degrees=True)).as_quat(scalar_first=True).tolist(),
    },
}
OMEGA_BODY = np.array([0.02, 0.01, -0.015])


def lidar_from_target(time_s: float) -> RigidTransform:
    start = Rotation.from_euler("zyx", [20.0, -50.0, 10.0], degrees=True)
    turned = start * Rotation.from_rotvec(time_s * np.array([0.02, -0.03, 0.01]))
    return RigidTransform.from_components([0.3 + 0.001 * time_s, -0.2, 60.0 - 0.01 * time_s], turned)


def truth_row(time_s: float) -> dict[str, float]:
    pose, scan = lidar_from_target(time_s), lidar_from_target(time_s - LIDAR.delay_s)
    row = dict.fromkeys(TRUTH_COLUMNS, float("nan")) | pose_columns(pose) | {"range_m": float(np.linalg.norm(pose.translation))}
    row |= {f"scan_{name}": value for name, value in pose_columns(scan).items()}
    row |= dict(zip(("omega_body_x_rad_s", "omega_body_y_rad_s", "omega_body_z_rad_s"), OMEGA_BODY.tolist()))
    row |= {"rel_x_m": 30.0 + 0.01 * time_s, "rel_y_m": -0.066 * time_s, "rel_z_m": 60.0}
    row |= {"rel_vx_m_s": 0.01, "rel_vy_m_s": -0.066, "rel_vz_m_s": 0.0, "returns": 81.0}
    return row


def fabricated_scan(frame: int) -> tuple[Scan, dict[str, np.ndarray]]:
    """A square of returns in the middle: its left column at an edge, its top row grazing, a false alarm in a corner."""
    reason = np.full((SIZE, SIZE), BeamFate.NOTHING, dtype=np.uint8)
    reason[8:17, 8:17] = BeamFate.RETURN
    reason[7, 8:17] = BeamFate.GRAZING
    reason[0, 0] = BeamFate.FALSE_ALARM
    there = np.isin(reason, (BeamFate.RETURN, BeamFate.FALSE_ALARM))
    energy = np.where(there, 1.0, 0.0)
    energy[8:17, 8] = 0.5
    range_m = 60.0 + 0.05 * np.random.default_rng(frame).normal(size=there.shape)
    points = np.where(there[..., None], LIDAR.pattern.beams.directions_lidar * range_m[..., None], np.nan)
    strength = np.where(there, np.linspace(1, 2, SIZE), np.nan)
    scan = Scan(points.astype(np.float32), strength.astype(np.float32), np.full((SIZE, SIZE), -0.05, np.float32))
    return scan, {"reason": reason, "energy_fraction": energy.astype(np.float32), "range_m": range_m.astype(np.float32)}


@pytest.fixture(scope="session")
def make_lidar() -> Callable[..., Dataset]:
    """make_lidar(path, frames=range(40), seed=0, rate_hz=1.0, target=TARGET, lidars=("lidar",)) → an opened data set."""

    def make(
        path: Path,
        frames: range = range(40),
        seed: int = 0,
        rate_hz: float = 1.0,
        target: Any = TARGET,
        lidars: tuple[str, ...] = ("lidar",),
    ) -> Dataset:
        spec = Target.model_validate(target).model_dump(mode="json")
        described = {name: LIDAR.model_dump(mode="json") for name in lidars}
        manifest = Manifest.of(
            scenario={"description": "a tumbling box", "target": spec, "motion": {"type": "by hand"}, "lidars": described},
            seed=seed,
            frames=frames,
            sensors={name: lidar_entry(LIDAR.model) for name in lidars},
            backend={"variant": "by hand"},
            quality="draft",
        )
        writer = DatasetWriter.open(path, manifest)
        for frame in frames:
            scan, beams = fabricated_scan(frame)
            time_s = frame / rate_hz
            truth = {name: truth_row(time_s) for name in lidars}
            scans, beams_of = dict.fromkeys(lidars, scan), dict.fromkeys(lidars, beams)
            writer.write(FrameRecord(frame, time_s, {}, {}, truth, scans=scans, scan_truth=beams_of))
        writer.finish()
        return Dataset.open(path)

    return make


@pytest.fixture(scope="session")
def lidar_dataset(make_lidar: Callable[..., Dataset], tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    return make_lidar(tmp_path_factory.mktemp("data") / "tumble")


@pytest.fixture(scope="session")
def lidar_target() -> dict[str, Any]:
    return dict(TARGET)


SIGMAS = np.repeat([0.01, 1e-4, 0.02, 0.05, 0.002, 0.03], (3, 3, 5, 3, 3, 3))


@dataclass(frozen=True)
class Fabricator:
    """Answers made of the truth: in a frame of the method's own, with errors drawn from a covariance that it states."""

    dataset: Dataset

    def covariance(self, random: np.random.Generator) -> np.ndarray:
        """A full covariance of the 20 states with the σ of ``SIGMAS``."""
        mixing = np.eye(20) + 0.15 * random.normal(size=(20, 20))
        correlation = mixing @ mixing.T
        scale = SIGMAS / np.sqrt(np.diag(correlation))
        return correlation * np.outer(scale, scale)

    def states(self, time_s: float, target_from_own: RigidTransform, error: np.ndarray) -> tuple[RigidTransform, dict[str, float]]:
        """lidar_from_own at ``time_s`` and the extras, the truth plus ``error`` (20,) [θ, ω, j, r, v, ρ]."""
        mass, own_from_target = mass_of(self.dataset.manifest.scenario), target_from_own.inv()
        assert mass is not None
        own_from_body, row = own_from_target * mass.target_from_body, truth_row(time_s)
        theta, omega, j, r, v, rho = np.split(error, [3, 6, 11, 14, 17])
        axes = own_from_body.rotation.as_matrix()
        inertia = components_of(axes @ np.diag(mass.principal_kg_m2) @ axes.T) + j
        named = {f"inertia_{place}": value for place, value in enumerate(inertia, start=1)}
        for place, axis in enumerate("xyz"):
            named[f"omega_{axis}_rad_s"] = own_from_body.rotation.apply(OMEGA_BODY)[place] + omega[place]
            named[f"rel_{axis}_m"] = row[f"rel_{axis}_m"] + r[place]
            named[f"rel_v{axis}_m_s"] = row[f"rel_v{axis}_m_s"] + v[place]
            named[f"com_{axis}_m"] = own_from_body.translation[place] - rho[place]
        lidar_from_own = lidar_from_target(time_s) * target_from_own
        turned = lidar_from_own.rotation * Rotation.from_rotvec(theta)
        return RigidTransform.from_components(lidar_from_own.translation, turned), {key: float(one) for key, one in named.items()}

    def answers(
        self,
        target_from_own: RigidTransform | None = None,
        errors: np.ndarray | None = None,
        covariances: np.ndarray | None = None,
        more: Callable[[int], dict[str, float]] = lambda _: {},
        missing: tuple[int, ...] = (),
        title: str = "exact",
        sensor: str = "lidar",
    ) -> Predictions:
        """One row a frame; without ``target_from_own`` the method was told the model."""
        gauge = RigidTransform.identity() if target_from_own is None else target_from_own
        rows, extras, times = [], [], self.dataset.truth_table().set_index("frame")["time_s"]
        for place, frame in enumerate(self.dataset.frames):
            error = np.zeros(20) if errors is None else errors[place]
            pose, named = self.states(float(times[frame]), gauge, error)
            if covariances is not None:
                named |= {f"cov_{i}_{j}": float(covariances[place, i, j]) for i in range(20) for j in range(i, 20)}
            answered = frame not in missing
            columns = pose_columns(pose) if answered else dict.fromkeys(COLUMNS[3:10], float("nan"))
            outcome = {"outcome": "ok" if answered else "diverged", "cpu_s": 0.1, "wall_s": 0.1}
            rows.append({"frame": frame, "sensor": sensor, **columns, **outcome})
            reason = "" if answered else "no <return> for 30 scans"
            extras.append({"frame": frame, "sensor": sensor, "reason": reason, **(named | more(frame) if answered else {})})
        model = ModelRecord(points=10, digest="0") if target_from_own is None else None
        record = RunRecord(
            format="hardlight-predictions", version=1, method=title, dataset_identity=self.dataset.identity,
            knowledge=KnowledgeRecord(sensors=(), lidars=("lidar",), model=model),
        )  # fmt: skip
        return Predictions(record, pd.DataFrame(rows, columns=list(COLUMNS)), pd.DataFrame(extras))


@pytest.fixture(scope="session")
def fabricate() -> type[Fabricator]:
    return Fabricator


@pytest.fixture(scope="session")
def icp_of() -> Callable[[RigidTransform], Callable[[int], dict[str, float]]]:
    """icp_of(own_error, target_from_own=identity) → frame → the extras of a registration that is off by ``own_error``."""

    def make(off: RigidTransform, target_from_own: RigidTransform | None = None) -> Callable[[int], dict[str, float]]:
        gauge = RigidTransform.identity() if target_from_own is None else target_from_own

        def extras(frame: int) -> dict[str, float]:
            columns = pose_columns(lidar_from_target(frame - LIDAR.delay_s) * off * gauge)
            return {f"icp_{name}": value for name, value in columns.items()}

        return extras

    return make
