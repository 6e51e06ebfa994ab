"""A few scans as points that the page's script turns: positions on a grid of 16 bits, a byte each for strength, fate and part."""

import base64
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from benchmark.errors import PredictionsError
from benchmark.gallery_answers import Answers
from benchmark.gallery_command import command
from benchmark.gallery_lidars import Reading, answered_at_scan
from benchmark.report_lidar_pictures import LEGEND
from scenes.arrays import Floats
from scenes.beam_fate import BeamFate
from scenes.dataset import Dataset
from scenes.errors import DatasetError
from scenes.solids import Solid

MOST_SCANS, MOST_POINTS, _MOST_ANSWERS = 4, 6000, 6
_ENOUGH = 0.5  # of the returns of a track's fullest scan
_STEPS = 32767  # of the grid, either side of its middle
_LOST = (BeamFate.GATED, BeamFate.GRAZING, BeamFate.MIRROR, BeamFate.DARK, BeamFate.CUT_OFF)
_SIGNS = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)])


@dataclass(frozen=True, slots=True, eq=False)
class Scan3D:
    """``data``: what the script draws, for JSON. ``alternative``: the same in words."""

    key: str
    heading: str
    alternative: str
    command: str
    data: Mapping[str, Any]


def choose_scans(frames: pd.DataFrame, answers: Answers, most: int = MOST_SCANS) -> tuple[pd.DataFrame, ...]:
    """At most ``most`` scans, of cases evenly spread: of each the worst answered frame among its scans with many returns.

    Each scan is the pooled rows of its frame, a row a method. A case without any return is passed over, and so is a scan that
    another case has just so, as a LIDAR sees the same in any light.
    """
    scanned = frames[frames["modality"] == "lidar"]
    cases = [full for _, case in scanned.groupby("case", sort=False) if len(full := _full(case, answers))]
    if not cases:
        return ()
    places = np.unique(np.linspace(0, len(cases) - 1, min(most, len(cases))).round().astype(int))
    chosen, taken = [], set[tuple[float, ...]]()
    for place in places.tolist():
        full = cases[place]
        fresh = full[[one not in taken for one in zip(full["frame"], full["range_m"], full["returns"])]]
        if len(fresh):
            worst = fresh["score"].fillna(-1.0).to_numpy(dtype=np.float64)
            row = fresh.iloc[int(np.argmax(worst))]
            taken.add((row["frame"], row["range_m"], row["returns"]))
            chosen.append(full[full["frame"] == row["frame"]])
    return tuple(chosen)


def _full(case: pd.DataFrame, answers: Answers) -> pd.DataFrame:
    """The rows of a case's first run whose scans have many returns, which is a column; none where the data set is not there."""
    run: pd.DataFrame = case[case["run"] == case["run"].iloc[0]]
    sensor = run["sensor"].iloc[0]
    run = run[run["sensor"] == sensor]
    try:
        truth = answers.dataset(run.iloc[0]).truth_table()
    except DatasetError:
        return run.iloc[:0]
    counted = truth[truth["sensor"] == sensor].set_index("frame")["returns"]
    run = run.assign(returns=run["frame"].map(counted))
    full: pd.DataFrame = run[run["returns"] >= max(1.0, _ENOUGH * float(counted.max()))]
    return full


def scans_3d(chosen: Sequence[pd.DataFrame], answers: Answers, titles: Sequence[str], bases: Mapping[str, str]) -> Iterator[Scan3D]:
    """The scans that can be read. ``bases``: a run → its case, under whose name the command stands."""
    for number, rows in enumerate(chosen):
        try:
            line = command(answers.dataset(rows.iloc[0]).manifest, int(rows["frame"].iloc[0]), _base(rows, bases))
            yield _scan(rows, answers, titles, number, line)
        except (DatasetError, PredictionsError):
            continue


def _base(rows: pd.DataFrame, bases: Mapping[str, str]) -> str:
    run = str(rows["run"].iloc[0])
    return bases.get(run, run)


def _scan(rows: pd.DataFrame, answers: Answers, titles: Sequence[str], number: int, line: str) -> Scan3D:
    row = rows.iloc[0]
    dataset, lidar, frame = answers.dataset(row), str(row["sensor"]), int(row["frame"])
    reading, parts = Reading.of(dataset, lidar, frame), answers.solids(dataset)
    poses = [_pose("true pose", None, reading.true, parts)]
    for _, one in rows[rows["answered"]].head(_MOST_ANSWERS).iterrows():
        given = answered_at_scan(dataset, one, answers.of(one), reading)
        if given is not None:
            poses.append(_pose(str(one["method"]), titles.index(one["method"]), given, parts))
    data = packed(reading) | {"poses": poses, "parts": _part_names(dataset, lidar)}
    data["centre"] = np.round(reading.true.translation, 4).tolist()
    heading = f"{row['run']}, {lidar}, frame {frame}"
    said = _alternative(reading, rows, len(data["poses"]) - 1)
    return Scan3D(f"scan3d-{number}", heading, said, line, data)


def packed(reading: Reading) -> dict[str, Any]:
    """The points of a reading as base64, at most ``MOST_POINTS``: returns where they were measured, lost beams at their true range.

    ``xyz``: little-endian int16, a point p is ``origin`` + ``step`` · p, so it is off by at most half a step an axis. ``strength``,
    ``fate``, ``part``: a byte each.
    """
    points, fates = reading.points_lidar, reading.fates
    lost = np.isin(reading.truth["reason"], _LOST) & ~reading.has_return & (reading.truth["range_m"] > 0)
    shown = np.flatnonzero(reading.has_return | lost)
    shown = shown[np.linspace(0, len(shown) - 1, min(len(shown), MOST_POINTS)).round().astype(int)] if len(shown) else shown
    distance_m = np.nan_to_num(reading.truth["range_m"].astype(np.float64))[:, None]
    places = np.where(lost[:, None], reading.directions_lidar * distance_m, np.nan_to_num(points))[shown]
    low, high = (places.min(axis=0), places.max(axis=0)) if len(shown) else (np.zeros(3), np.zeros(3))
    origin = np.round((low + high) / 2, 4)
    step = max(float(np.abs(np.array([low - origin, high - origin])).max()) / _STEPS, 1e-6)
    there = reading.has_return[shown]
    return {
        "count": len(shown),
        "origin": origin.tolist(),
        "step": step,
        "xyz": _base64(np.round((places - origin) / step).astype("<i2")),
        "strength": _base64(_strengths(reading.strength[shown], there)),
        "fate": _base64(fates[shown]),
        "part": _base64(np.minimum(reading.parts[shown], 255).astype(np.uint8)),
        "lost": _base64((~there).astype(np.uint8)),
    }


def _strengths(strength: Floats, there: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """The square root of the strength, its 99th percentile at 255."""
    root = np.sqrt(np.maximum(np.nan_to_num(strength), 0))
    top = max(float(np.percentile(root[there], 99)), 1e-30) if there.any() else 1.0
    return np.asarray(np.round(255 * np.clip(root / top, 0, 1)), dtype=np.uint8)


def _pose(name: str, series: int | None, lidar_from_target: RigidTransform, parts: tuple[Solid, ...]) -> dict[str, Any]:
    """The corners of the box about the target and the ends of its axes at a pose, in LIDAR axes, metres."""
    points = np.concatenate([one.vertices_target for one in parts]) if parts else np.array([(-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)])
    low, high = points.min(axis=0), points.max(axis=0)
    corners = low + _SIGNS * (high - low)
    axes = np.vstack([np.zeros(3), 0.6 * float((high - low).max()) * np.eye(3)])
    placed = (np.round(lidar_from_target.apply(one), 3).tolist() for one in (corners, axes))
    return {"name": name, "series": series, **dict(zip(("corners", "axes"), placed, strict=True))}


def _part_names(dataset: Dataset, lidar: str) -> list[str]:
    """The names by ``part_id``, as the manifest has them."""
    names = dataset.manifest.sensors[lidar].get("parts", [])
    return [str(name) for name in names] if isinstance(names, list) else []


def _alternative(reading: Reading, rows: pd.DataFrame, drawn: int) -> str:
    row, there = rows.iloc[0], reading.truth["reason"] == BeamFate.RETURN
    ranges = np.linalg.norm(reading.points_lidar[there], axis=1)
    far = f" between {ranges.min():.1f} and {ranges.max():.1f} m" if len(ranges) else ""
    fates = np.bincount(reading.fates[~reading.has_return & (reading.fates != 255)], minlength=len(LEGEND))
    lost = ", ".join(f"{count} {name}" for count, (name, _) in zip(fates.tolist(), LEGEND) if count)
    target = f"; the target stands at {row['range_m']:.1f} m" if np.isfinite(row["range_m"]) else ""
    boxes = f"{drawn} answered pose{'s' if drawn != 1 else ''}" if drawn else "no answered pose"
    return f"{int(there.sum())} returns{far}{target}; beams lost on it: {lost or 'none'}; the true pose and {boxes} as boxes."


def _base64(values: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()
