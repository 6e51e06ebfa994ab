"""The truth of a scan: of each beam, and its row of the truth table."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from renderer.beams import Echoes
from renderer.reports import Reports
from renderer.scan_poses import ScanPoses
from scenes.arrays import Floats
from scenes.beam_fate import COUNTS, BeamFate
from scenes.dataset_layout import POSE_COLUMNS, TRUTH_COLUMNS
from scenes.lidar import Lidar
from scenes.pose_columns import pose_columns
from scenes.scenario import Scene


def scan_truth(reports: Reports, echoes: Echoes, rays_lidar: Floats, poses: ScanPoses) -> dict[str, NDArray[Any]]:
    """Name → (blocks, beams) or (blocks, beams, 3), NaN or 0 where a beam meets nothing.

    ``range_m``, ``incidence_rad``, ``part_id``: true, of the sub-ray nearest to the beam's axis that belongs to the return.
    ``deskewed_m``: where it met the target, as if all beams were fired at the middle of the scan, LIDAR axes; returns only.
    ``energy_fraction``, ``electrons``, ``reason``: see ``Reports``.
    """
    block, beam = np.nonzero(reports.source >= 0)
    source = reports.source[block, beam]
    shape = reports.source.shape
    range_m, incidence = np.full(shape, np.nan, np.float32), np.full(shape, np.nan, np.float32)
    part_id, deskewed_m = np.zeros(shape, np.uint16), np.full((*shape, 3), np.nan, np.float32)
    range_m[block, beam] = echoes.range_m[beam, source]
    incidence[block, beam] = np.arccos(np.clip(echoes.cosine[beam, source].astype(np.float64), -1, 1))
    part_id[block, beam] = echoes.part[beam, source]
    seen = reports.fate[block, beam] == BeamFate.RETURN
    points = rays_lidar[beam[seen], source[seen]] * echoes.range_m[beam[seen], source[seen], None]
    deskewed_m[block[seen], beam[seen]] = poses.at_reference(beam[seen], points)
    return {
        "range_m": range_m,
        "incidence_rad": incidence,
        "part_id": part_id,
        "energy_fraction": reports.energy_fraction.astype(np.float32),
        "electrons": reports.electrons.astype(np.float32),
        "reason": reports.fate,
        "deskewed_m": deskewed_m,
    }


def truth_row(
    lidar_from_target: RigidTransform, at_scan: RigidTransform, scene: Scene, lidar: Lidar, fate: NDArray[np.uint8]
) -> dict[str, float]:
    """A LIDAR's row of the truth table: the pose at the frame's time, the pose at the middle of the scan, counts of beams."""
    range_m = float(np.linalg.norm(lidar_from_target.translation))
    row = dict.fromkeys(TRUTH_COLUMNS, float("nan")) | pose_columns(lidar_from_target) | {"range_m": range_m}
    row |= dict(zip(("omega_x_rad_s", "omega_y_rad_s", "omega_z_rad_s"), scene.omega_target_rad_s))
    if scene.lights:
        light = lidar.mount.chaser_from_cam.rotation.inv().apply(np.array(scene.lights[0].direction_chaser))
        row |= dict(zip(("light_x", "light_y", "light_z"), light.tolist()))
        cosine = -light @ lidar_from_target.translation / range_m if range_m > 0 else np.nan
        row["phase_angle_deg"] = float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    row |= {f"scan_{name}": value for name, value in zip(POSE_COLUMNS, pose_columns(at_scan).values())}
    counts = np.bincount(fate.ravel(), minlength=len(BeamFate))
    return row | {"returns": float(counts[BeamFate.RETURN])} | {name: float(counts[kind]) for kind, name in COUNTS.items()}
