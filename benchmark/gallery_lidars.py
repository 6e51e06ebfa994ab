"""Cards of LIDARs: the scan as a picture through a pinhole at the LIDAR, whatever its pattern, with the outlines over it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial import KDTree
from scipy.spatial.transform import RigidTransform

from benchmark.filter_truth import scan_pose
from benchmark.gallery_answers import Answers, Said
from benchmark.gallery_item import View
from benchmark.gallery_layers import SKY, Layer, coloured, stops
from benchmark.gallery_outlines import Shape, silhouette
from benchmark.gallery_window import Window
from benchmark.report_lidar_pictures import EDGE, FATES, LEGEND
from benchmark.report_pictures import bgr, data_uri
from scenes.arrays import Floats
from scenes.beam_fate import BeamFate
from scenes.dataset import Dataset
from scenes.intrinsics import Intrinsics
from scenes.lidar import Lidar
from scenes.recording import Scan

EDGE_SHARE = 0.98  # of a beam's energy on one surface, below which an edge cuts the beam
_WIDE_PX, _MARGIN, _SMALLEST = 340, 0.25, 0.004  # of a picture: width, margin on either side; least half width as a tangent
_REACH = 0.75  # of the beams' spacing: a pixel further from every beam shows none
_GOOD, _LOSSLESS = 70, 101


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """One scan, first returns only, beams in one row. ``true``: lidar_from_target in the middle of the scan.

    ``directions_lidar`` (n, 3), ``points_lidar`` (n, 3), ``strength`` (n,), NaN without a return; ``truth``: name → (n, ...).
    """

    directions_lidar: Floats
    points_lidar: Floats
    strength: Floats
    truth: Mapping[str, NDArray[Any]]
    true: RigidTransform

    @classmethod
    def of(cls, dataset: Dataset, lidar: str, frame: int) -> "Reading":
        """Reads a scan and its truth."""
        beams = Lidar.model_validate(dataset.scenario["lidars"][lidar]).pattern.beams.directions_lidar
        scan: Scan = dataset.observation(frame).scans[lidar]
        rows, count = beams.shape[0], beams.shape[0] * beams.shape[1]
        truth = {name: values[:rows].reshape(count, *values.shape[2:]) for name, values in dataset.scan_truth(frame, lidar).items()}
        points = scan.points_lidar[:rows].reshape(count, 3).astype(np.float64)
        strength = scan.intensity[:rows].reshape(count).astype(np.float64)
        true = scan_pose(dataset.truth(frame).row[lidar])
        assert true is not None  # every row of the truth table has a pose
        return cls(beams.reshape(count, 3), points, strength, truth, true)

    @property
    def has_return(self) -> NDArray[np.bool_]:
        """(n,) beams with a point."""
        return np.asarray(np.isfinite(self.points_lidar).all(axis=1))

    @property
    def parts(self) -> NDArray[Any]:
        """(n,) number of the part that a beam met, 0 for none."""
        return self.truth.get("part_id", np.zeros(len(self.strength), dtype=np.uint16))

    @property
    def fates(self) -> NDArray[np.uint8]:
        """(n,) index in ``LEGEND``, 255 for a beam that meets nothing."""
        found = np.full(len(self.strength), 255, dtype=np.uint8)
        for fate, name, _ in FATES:
            found[self.truth["reason"] == fate] = _INDEX[name]
        found[(self.truth["reason"] == BeamFate.RETURN) & (self.truth["energy_fraction"] < EDGE_SHARE)] = _INDEX[EDGE[0]]
        return found


_INDEX = {name: index for index, (name, _) in enumerate(LEGEND)}


def answered_at_scan(dataset: Dataset, row: pd.Series, said: Said, reading: Reading) -> RigidTransform | None:
    """The answered pose, which is of the frame's time, carried with the true motion to the middle of the scan."""
    true = dataset.truth(int(row["frame"])).sensor_from_target[str(row["sensor"])]
    given = said.pose(true, np.zeros(3))
    return None if given is None else given * true.inv() * reading.true


def lidar_views(answers: Answers, row: pd.Series, said: Said) -> tuple[View, ...]:
    """The view of a LIDAR at a pooled row's frame: strength of the returns, what became of the beams, ranges."""
    dataset, lidar = answers.dataset(row), str(row["sensor"])
    reading = Reading.of(dataset, lidar, int(row["frame"]))
    parts = answers.solids(dataset)
    corners = np.concatenate([one.vertices_target for one in parts]) if parts else np.zeros((1, 3))
    lens = _pinhole(reading.true.apply(corners))
    window = Window(0, 0, lens.width_px, lens.height_px)
    poses = {"true": reading.true, "answered": answered_at_scan(dataset, row, said, reading)}
    paths = {kind: silhouette(parts, pose, lens, window) for kind, pose in poses.items() if pose is not None}
    shapes = tuple(Shape(kind, path) for kind, path in paths.items() if path)
    return (View(lidar, window.width, window.height, tuple(_layers(reading, _nearest(reading, lens))), shapes),)


def _layers(reading: Reading, nearest: NDArray[np.int64]) -> Iterator[Layer]:
    """``nearest`` (height, width): the beam that a pixel shows, −1 for none."""
    there = (nearest >= 0) & reading.has_return[nearest]
    strength = np.sqrt(np.maximum(np.nan_to_num(reading.strength), 0))[nearest]
    top = float(np.percentile(strength[there], 99)) if there.any() else 1.0
    picture = coloured(strength, -0.1 * top, top, there, "cividis")
    yield Layer("picture", "Strength", data_uri(picture, _GOOD), stops("cividis"), "weak", "strong")
    fates = np.array([bgr(colour) for _, colour in LEGEND] + [bgr(SKY)], dtype=np.uint8)
    met = np.where(nearest >= 0, np.minimum(reading.fates[nearest], len(LEGEND)), len(LEGEND))
    yield Layer("fate", "Fate of beams", data_uri(fates[met], _LOSSLESS), swatches=tuple((c, name) for name, c in LEGEND))
    if there.any():
        ranges = np.linalg.norm(np.nan_to_num(reading.points_lidar), axis=1)[nearest]
        near, far = np.percentile(ranges[there], [1, 99])
        painted = coloured(ranges, near, far, there, "viridis_r")
        yield Layer("range", "Range", data_uri(painted, _GOOD), stops("viridis_r"), f"{near:.2f} m", f"{far:.2f} m")


def _nearest(reading: Reading, lens: Intrinsics) -> NDArray[np.int64]:
    """(height, width): the beam nearest to each pixel, −1 where none is near."""
    ahead = np.flatnonzero(reading.directions_lidar[:, 2] > 0)
    places = lens.project(reading.directions_lidar[ahead])
    tree = KDTree(places)
    apart = np.asarray(tree.query(places, k=[2])[0], dtype=np.float64)
    spacing = float(np.median(apart)) if len(places) > 1 else 1.0
    across, down = np.meshgrid(np.arange(lens.width_px, dtype=np.float64), np.arange(lens.height_px, dtype=np.float64))
    away, index = tree.query(np.stack([across, down], axis=-1), distance_upper_bound=_REACH * max(spacing, 1.34))
    return np.asarray(np.where(np.isfinite(away), ahead[np.minimum(index, len(ahead) - 1)], -1), dtype=np.int64)


def _pinhole(points_lidar: Floats) -> Intrinsics:
    """A lens at the LIDAR that sees (n, 3) points with a margin; one degree about the axis where none is ahead."""
    ahead = points_lidar[points_lidar[:, 2] > 0]
    slopes = ahead[:, :2] / ahead[:, 2:] if len(ahead) else np.zeros((1, 2))
    low, high = slopes.min(axis=0), slopes.max(axis=0)
    half = np.maximum((high - low) * (0.5 + _MARGIN), _SMALLEST)
    half[1] = np.clip(half[1], half[0] / 2, half[0])
    half[0] = max(half[0], half[1])
    focal_px, middle = _WIDE_PX / (2 * half[0]), (low + high) / 2
    height = max(2, round(float(2 * half[1] * focal_px)))
    centre = np.array([(_WIDE_PX - 1) / 2, (height - 1) / 2]) - focal_px * middle
    return Intrinsics(_WIDE_PX, height, focal_px, focal_px, float(centre[0]), float(centre[1]))
