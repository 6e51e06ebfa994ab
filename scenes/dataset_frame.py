"""One frame of a data set: what is written for it, and the text of its frame.json."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from numpy.typing import NDArray

from scenes.dataset_layout import FRAME_FILE, POSE_COLUMNS, TRUTH_COLUMNS, frame_folder
from scenes.errors import DatasetError
from scenes.exr import Window
from scenes.pose_columns import pose
from scenes.provenance import readable_json, sha256_of_json
from scenes.recording import Scan, Truth

_EMPTY: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True, slots=True, eq=False)
class FrameRecord:
    """Everything that is written for one frame.

    ``images``: camera → (height, width), uint8 or uint16, DN. ``layers``: camera → layer name → (height, width), float32 or
    uint32. ``truth``: sensor → column → number, all of ``TRUTH_COLUMNS`` (NaN where one does not apply) and any others.
    ``state``: plain, JSON (motion state, light truth, exposure). ``windows``: camera → where in the picture its layers lie,
    if they have not the picture's size; outside it they are zero. ``scans``: LIDAR → scan. ``scan_truth``: LIDAR → name →
    (rows, columns) or (rows, columns, 3).
    """

    frame: int
    time_s: float
    images: Mapping[str, NDArray[Any]]
    layers: Mapping[str, Mapping[str, NDArray[Any]]]
    truth: Mapping[str, Mapping[str, float]]
    state: Mapping[str, Any] = field(default_factory=lambda: _EMPTY)
    windows: Mapping[str, Window] = field(default_factory=lambda: _EMPTY)
    scans: Mapping[str, Scan] = field(default_factory=lambda: _EMPTY)
    scan_truth: Mapping[str, Mapping[str, NDArray[Any]]] = field(default_factory=lambda: _EMPTY)

    def __post_init__(self) -> None:
        """Refuses truth without one of the columns, and a quaternion that is not one."""
        for sensor, row in self.truth.items():
            missing = [name for name in TRUTH_COLUMNS if name not in row]
            if missing:
                raise ValueError(f"the truth of {sensor!r} lacks {', '.join(missing)}")
            norm = math.hypot(*(row[name] for name in POSE_COLUMNS[:4]))
            if not (abs(norm - 1) < 1e-9 and row["qw"] >= 0):
                raise ValueError(f"the truth of {sensor!r} has quaternion norm {norm}, qw {row['qw']}; see pose_columns")


def frame_json(record: FrameRecord, files: Mapping[str, str]) -> str:
    """The text of frame.json; ``files``: file name → SHA-256. NaN is written as null. It carries a digest of itself."""
    body = {
        "frame": record.frame,
        "time_s": record.time_s,
        "sensors": {sensor: _sensor(row) for sensor, row in record.truth.items()},
        "state": dict(record.state),
        "files": dict(files),
    }
    return readable_json(body | {"digest": sha256_of_json(body)})


def read_frame_json(dataset: Path, frame: int) -> dict[str, Any]:
    """frame.json of one frame, checked against its own digest. Raises ``DatasetError``."""
    path = frame_folder(dataset, frame) / FRAME_FILE
    try:
        body = json.loads(path.read_bytes())
        stated = body.pop("digest")
        files, sensors, number = body["files"], body["sensors"], body["frame"]
    except FileNotFoundError:
        raise DatasetError(f"{path}: it is missing; render the frame again with --resume") from None
    except (ValueError, KeyError, AttributeError, TypeError) as error:
        raise DatasetError(f"{path}: it is truncated or edited ({error!r})") from None
    found = sha256_of_json(body)
    if stated != found or number != frame or not isinstance(files, dict) or not isinstance(sensors, dict):
        raise DatasetError(f"{path}: it states digest {stated}, its content has {found}: it was edited")
    return dict(body)


def truth_rows(body: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """Sensor → truth columns of a frame.json; null comes back as NaN."""
    return {name: _numbers(entry["sensor_from_target"] | entry["truth"]) for name, entry in body["sensors"].items()}


def truth_of(body: Mapping[str, Any]) -> Truth:
    """The truth of a frame.json as the judge takes it."""
    rows = truth_rows(body)
    poses = {sensor: pose(row) for sensor, row in rows.items()}
    return Truth(int(body["frame"]), float(body["time_s"]), MappingProxyType(poses), MappingProxyType(rows))


def _sensor(row: Mapping[str, float]) -> dict[str, Any]:
    numbers = {name: None if math.isnan(value) else float(value) for name, value in row.items()}
    placed = {name: numbers.pop(name) for name in POSE_COLUMNS}
    return {"sensor_from_target": placed, "truth": numbers}


def _numbers(row: Mapping[str, float | None]) -> dict[str, float]:
    return {name: math.nan if value is None else float(value) for name, value in row.items()}
