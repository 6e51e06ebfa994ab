"""bounds.parquet: of each frame and sensor of a data set how well anybody could know the pose."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from benchmark.filter_truth import scan_pose
from benchmark.information import SAMPLES
from benchmark.information.columns import UPPER, columns_of, informations
from benchmark.information.fisher import Bound, bound, stereo_bound
from benchmark.information.pictures import PictureInformation
from benchmark.information.scans import ScanInformation
from scenes.arrays import Floats
from scenes.dataset import Dataset
from scenes.recording import StereoPair
from scenes.scenario import Scenario

__all__ = ["UPPER", "bounds_table", "frame_rows", "informations", "sensors_of"]

Progress = Callable[[int, int], None]


def bounds_table(
    dataset: Dataset,
    frames: Iterable[int] | None = None,
    progress: Progress | None = None,
    sensors: Iterable[str] | None = None,
    samples: int = SAMPLES,
    light_direction: bool = False,
) -> pd.DataFrame:
    """A row per (frame, sensor): ``information_<a>_<b>`` (the upper triangle), ``sigma_<a>``, both in rad and m in the sensor's
    axes, and their sums ``sigma_rotation_rad``, ``sigma_position_m``; NaN σ where the pose is undetermined. Of a camera all this is
    ``PictureBounds.taken``; where ``least_eigenvalue`` is zero, below or NaN, the variant ``rendered``.

    ``sensors``: cameras, rigs and LIDARs, all of them where left out. ``samples``: of each pixel in each of the renderings. Of a
    camera also ``*_rendered``, ``*_gain_and_offset``, ``*_model_5`` and, where asked for, ``*_light_direction`` (``PictureBounds``)
    and ``inflation``; of a LIDAR ``beams`` and ``leverage``. A rig's row is in its left camera's axes and holds what both pictures
    tell together.
    """
    chosen = list(dataset.frames if frames is None else frames)
    wanted = list(sensors_of(dataset) if sensors is None else sensors)
    of_frames = frame_rows(dataset, chosen, wanted, progress, samples=samples, light_direction=light_direction)
    return pd.DataFrame([row for rows in of_frames for row in rows])


def frame_rows(
    dataset: Dataset, frames: Sequence[int], sensors: Sequence[str], progress: Progress | None = None, **how: Any
) -> Iterator[list[dict[str, Any]]]:
    """Frame by frame the rows of ``bounds_table``, to be kept while it goes on; ``how``: of ``PictureInformation``."""
    scenario, truth = Scenario.model_validate(dataset.scenario), dataset.truth_table().set_index(["frame", "sensor"])
    makers = _makers(dataset, scenario, truth, sensors, how)
    done, total = 0, len(frames) * len(makers)
    for frame in frames:
        found: dict[str, dict[str, float]] = {}
        for sensor, make in makers.items():
            found[sensor], done = make(frame), done + 1
            if progress is not None:
                progress(done, total)
        found |= {name: _rig_row(dataset.rigs[name], found) for name in sensors if name in dataset.rigs}
        yield [{"frame": frame, "sensor": sensor, **found[sensor]} for sensor in sensors]


def sensors_of(dataset: Dataset) -> list[str]:
    """Everything that sees the target: cameras, rigs, LIDARs."""
    return [*dataset.sensors, *dataset.rigs, *dataset.lidars]


def _makers(
    dataset: Dataset, scenario: Scenario, truth: pd.DataFrame, wanted: Sequence[str], how: Mapping[str, Any]
) -> dict[str, Callable[[int], dict[str, float]]]:
    """For each sensor that is wanted, or belongs to a rig that is, what gives a frame's row."""
    pairs = [dataset.rigs[name] for name in wanted if name in dataset.rigs]
    needed = {*wanted, *(name for pair in pairs for name in (pair.left, pair.right))}

    def of_camera(name: str) -> Callable[[int], dict[str, float]]:
        pictures = PictureInformation(scenario, name, **how)
        return lambda frame: _camera_row(pictures, frame, float(dataset.state(frame)["exposure_s"][name]))

    def of_lidar(name: str) -> Callable[[int], dict[str, float]]:
        scans = ScanInformation(scenario.target, scenario.lidars[name])
        return lambda frame: _lidar_row(scans, dataset.scan_truth(frame, name), truth.loc[[(frame, name)]].iloc[0])

    cameras = {name: of_camera(name) for name in dataset.sensors if name in needed}
    return cameras | {name: of_lidar(name) for name in dataset.lidars if name in needed}


def _camera_row(pictures: PictureInformation, frame: int, exposure_s: float) -> dict[str, float]:
    found = pictures.bounds(frame, exposure_s)
    row = dict(columns_of(found.taken)) | {"least_eigenvalue": found.known.least_eigenvalue, "inflation": found.inflation}
    for name in ("rendered", "gain_and_offset", "model_5", "light_direction"):
        variant: Bound | None = getattr(found, name)
        if variant is not None:
            row |= {f"sigma_rotation_rad_{name}": variant.rotation_rad, f"sigma_position_m_{name}": variant.position_m}
    return row


def _rig_row(pair: StereoPair, found: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    left, right = (bound(_information(found[name])) for name in (pair.left, pair.right))
    both = stereo_bound(left, right, pair.right_from_left.rotation.inv())
    inflations = [found[name]["inflation"] for name in (pair.left, pair.right)]
    return dict(columns_of(both)) | {"least_eigenvalue": both.least_eigenvalue, "inflation": float(np.max(inflations))}


def _information(row: Mapping[str, float]) -> Floats:
    """(6, 6) of one row."""
    return np.asarray(informations(pd.DataFrame([row]))[0])


def _lidar_row(scans: ScanInformation, beams: dict[str, Any], truth: "pd.Series[Any]") -> dict[str, float]:
    at_scan = scan_pose({str(name): value for name, value in truth.items()})
    assert at_scan is not None  # every row of the truth table has a pose
    found = scans.bound(beams, at_scan)
    extra = {"beams": float(found.beams), "leverage": found.leverage, "least_eigenvalue": found.bound.least_eigenvalue}
    return dict(columns_of(found.bound)) | extra
