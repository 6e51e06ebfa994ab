"""What a few trial scans tell of a LIDAR before hours are spent: its cost, and whether it sees anything at all."""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from renderer.ranging import Scanner, Sounding
from scenes.beam_fate import COUNTS, BeamFate
from scenes.beam_truth import encode_beams
from scenes.errors import UsageError
from scenes.pcd import encode_scan
from scenes.pose_columns import pose
from scenes.scan_pattern import half_field_rad
from scenes.scenario import Scenario, realize

TRIALS = 8
_SLOW_TRIALS = 3  # where rays are traced one by one
_ENOUGH = 3  # scans that must all fail before a rendering is refused: one alone may be meant


@dataclass(frozen=True, slots=True)
class ScanPlan:
    """Of one LIDAR: ``beams`` of a scan, CPU seconds and bytes of one, ``warnings`` as whole sentences."""

    beams: int
    cpu_s: float
    disk_bytes: float
    warnings: tuple[str, ...]


def scan_plan(scenario: Scenario, name: str, frames: list[int]) -> ScanPlan:
    """Scans some of ``frames``. Raises ``UsageError`` where none of them has a beam that meets the target within the gate."""
    scanner, start = Scanner(scenario, name), time.process_time()
    tried = {frame: scanner.take(realize(scenario, scenario.seed, frame)) for frame in _tried(frames, scanner.is_slow)}
    cast_s = time.process_time()
    last = tried[max(tried)]
    size = len(encode_scan(last.scan)) + len(encode_beams(last.beams))
    encode_s = time.process_time() - cast_s
    _refuse_blind(scenario, name, tried)
    warnings = tuple(_warnings(name, tried))
    return ScanPlan(last.scan.intensity.size, (cast_s - start) / len(tried) + encode_s, float(size), warnings)


def _tried(frames: list[int], slow: bool) -> list[int]:
    count = min(_SLOW_TRIALS if slow else TRIALS, len(frames))
    return [frames[round(index * (len(frames) - 1) / max(count - 1, 1))] for index in range(count)]


def _refuse_blind(scenario: Scenario, name: str, tried: dict[int, Sounding]) -> None:
    """Raises where no beam of any scan meets the target, or all that beams meet lies outside of the gate."""
    lidar = scenario.lidars[name]
    if len(tried) < _ENOUGH:
        return
    if not any(_counts(one)[BeamFate.NOTHING] < one.beams["reason"].size for one in tried.values()):
        frame = min(tried)
        raise UsageError(
            f"lidars.{name}: in none of the {len(tried)} frames looked at does a beam meet the target, whose origin lies "
            f"{_off_axis(pose(tried[frame].truth))} in frame {frame}; beams reach {np.degrees(half_field_rad(lidar.pattern)):.3g} "
            "deg from the axis; look at pattern, mount and the motion's position"
        )
    if all(_only_beyond_gate(one) for one in tried.values()):
        nearest_m = np.nanmin([np.nanmin(one.beams["range_m"], initial=np.inf) for one in tried.values()])
        raise UsageError(
            f"lidars.{name}.gate_m: all that beams meet in the {len(tried)} frames looked at lies outside of the gate, "
            f"{lidar.gate_m[0]:g} to {lidar.gate_m[1]:g} m; the nearest of it is {nearest_m:.4g} m away"
        )


def _off_axis(lidar_from_target: RigidTransform) -> str:
    x, y, z = lidar_from_target.translation
    return f"{np.degrees(np.arctan2(np.hypot(x, y), z)):.3g} deg off the LIDAR's axis at {np.linalg.norm([x, y, z]):.4g} m"


def _only_beyond_gate(one: Sounding) -> bool:
    counts = _counts(one)
    return bool(counts[[BeamFate.GATED, BeamFate.NOTHING, BeamFate.NO_SECOND]].sum() == counts.sum())


def _warnings(name: str, tried: dict[int, Sounding]) -> Iterator[str]:
    """Scans without a return, and why."""
    empty = {frame: _counts(one) for frame, one in tried.items() if not one.truth["returns"]}
    if not empty:
        return
    total = np.sum([*empty.values()], axis=0)
    causes = [f"{total[fate]} {COUNTS[fate].removeprefix('dropouts_').replace('_', ' ')}" for fate in COUNTS if total[fate]]
    why = f"beams that meet it: {', '.join(causes)}" if causes else "no beam meets the target"
    listed = ", ".join(str(frame) for frame in sorted(empty))
    yield f"lidars.{name}: a scan has no return in {len(empty)} of {len(tried)} frames looked at ({listed}); {why}"


def _counts(one: Sounding) -> NDArray[np.int64]:
    """Beams by their fate."""
    return np.bincount(one.beams["reason"].ravel(), minlength=len(BeamFate))
