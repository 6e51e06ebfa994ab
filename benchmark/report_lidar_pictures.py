"""Pictures of scans: by strength of the return, by what became of each beam, and from the side over the target's silhouette.

The colours are those of Okabe & Ito (2008), told apart whatever kind of colours a reader sees; strength is ``cividis``, which is
as light as it is strong. The pictures have a dark ground of their own, so they look the same on a light page and on a dark one.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cv2
import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from benchmark.filter_truth import scan_pose
from benchmark.report_pictures import bgr, data_uri
from benchmark.report_scan_grid import ScanGrid, grid_of
from scenes.arrays import Floats
from scenes.beam_fate import BeamFate
from scenes.dataset import Dataset
from scenes.recording import Scan
from scenes.solids import Solid

_GROUND, _SILHOUETTE = "#101318", "#3b434e"
_EDGE_SHARE = 0.98  # of a beam's energy on one surface, below which it is shared with what lies beside or behind
EDGE = ("return at an edge", "#009e73")
# What a beam became and its colour, in the order of the legend; the rest of the sky is the ground.
FATES = (
    (BeamFate.RETURN, "return", "#e8e8e4"),
    (BeamFate.GRAZING, "too grazing", "#e69f00"),
    (BeamFate.CUT_OFF, "dead zone of the paper", "#d55e00"),
    (BeamFate.MIRROR, "mirrored away", "#cc79a7"),
    (BeamFate.DARK, "too dark or far", "#56b4e9"),
    (BeamFate.GATED, "outside of the gate", "#0072b2"),
    (BeamFate.FALSE_ALARM, "false alarm", "#f0e442"),
)
LEGEND = (("return", "#e8e8e4"), EDGE, *((name, colour) for fate, name, colour in FATES[1:]))
_SIDE_PX, _MARGIN_M = (560, 360), 0.8


@dataclass(frozen=True, slots=True, eq=False)
class Tile:
    """One picture as a data URI, with what it shows."""

    uri: str
    width: int
    height: int
    label: str


@dataclass(frozen=True, slots=True, eq=False)
class ScanStrip:
    """One scan, three ways."""

    caption: str
    tiles: tuple[Tile, ...]


def scan_strip(dataset: Dataset, lidar: str, frame: int, solids: tuple[Solid, ...], caption: str) -> ScanStrip:
    """The pictures of one scan. ``solids``: the target's triangles, for its silhouette."""
    scan, truth = dataset.observation(frame).scans[lidar], dataset.scan_truth(frame, lidar)
    grid = grid_of(dataset.scenario["lidars"], lidar, truth["reason"])
    strong = _tile(grid.picture(_strengths(scan.intensity)), f"strength of the returns, {caption}")
    fates = _tile(grid.picture(_fates(truth)), f"what became of each beam, {caption}")
    pose = scan_pose(dataset.truth(frame).row[lidar])
    side = _tile(_side_view(scan, truth, pose, solids), f"from the side, the LIDAR at the left, {caption}")
    return ScanStrip(caption, (strong, fates, side))


def intensity_tile(dataset: Dataset, lidar: str, frame: int, caption: str) -> Tile:
    """One scan as the methods see it, by the strength of its returns."""
    scan = dataset.observation(frame).scans[lidar]
    grid: ScanGrid = grid_of(dataset.scenario["lidars"], lidar, dataset.scan_truth(frame, lidar)["reason"])
    return _tile(grid.picture(_strengths(scan.intensity)), caption)


def _strengths(intensity: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(rows, columns, 3) blue-green-red: the square root of the strength, its 99th percentile at the bright end."""
    there = np.isfinite(intensity)
    if not there.any():
        return _painted(there, bgr(_GROUND))
    top = max(float(np.percentile(intensity[there], 99)), 1e-30)
    share = np.sqrt(np.clip(np.nan_to_num(intensity) / top, 0, 1))
    colours = mpl.colormaps["cividis"](0.12 + 0.88 * share)[..., 2::-1]
    return np.asarray(np.where(there[..., None], np.round(255 * colours), bgr(_GROUND)), dtype=np.uint8)


def _fates(truth: Mapping[str, NDArray[Any]]) -> NDArray[np.uint8]:
    """(rows, columns, 3) blue-green-red by what became of each beam."""
    picture = _painted(truth["reason"], bgr(_GROUND))
    for fate, _, colour in FATES:
        picture[truth["reason"] == fate] = bgr(colour)
    picture[_at_edge(truth)] = bgr(EDGE[1])
    return picture


def _at_edge(truth: Mapping[str, NDArray[Any]]) -> NDArray[np.bool_]:
    """Where a return comes from a beam that an edge cuts."""
    return np.asarray((truth["reason"] == BeamFate.RETURN) & (truth["energy_fraction"] < _EDGE_SHARE))


def _side_view(
    scan: Scan, truth: Mapping[str, NDArray[Any]], lidar_from_target: RigidTransform | None, solids: tuple[Solid, ...]
) -> NDArray[np.uint8]:
    """(height, width, 3): z to the right, y down, in LIDAR axes; the silhouette is the target's at the scan's reference instant."""
    there = np.isfinite(scan.points_lidar).all(axis=-1)
    points = scan.points_lidar[there].astype(np.float64)[:, [2, 1]]
    outline = [] if lidar_from_target is None else [lidar_from_target.apply(solid.vertices_target)[:, [2, 1]] for solid in solids]
    view = _Window.around(np.concatenate(outline) if outline else points)
    canvas = _painted(np.zeros(_SIDE_PX[::-1]), bgr(_GROUND))
    for solid, corners in zip(solids, outline):
        for triangle in view.pixels(corners)[solid.faces]:
            cv2.fillConvexPoly(canvas, triangle, bgr(_SILHOUETTE), lineType=cv2.LINE_8, shift=_SHIFT)
    colours = _fates(truth)[there]
    for place, colour in zip(view.pixels(points), colours.tolist()):
        cv2.circle(canvas, place.tolist(), 1 << _SHIFT, colour, cv2.FILLED, cv2.LINE_AA, _SHIFT)
    return canvas


_SHIFT = 4  # bits of a pixel's fraction in OpenCV's drawing


@dataclass(frozen=True, slots=True, eq=False)
class _Window:
    """What part of a plane a canvas shows."""

    centre_m: Floats
    px_per_m: float

    @classmethod
    def around(cls, points_m: Floats) -> "_Window":
        """The window that holds (n, 2) points with a margin; a metre about the origin where there are none."""
        low, high = (points_m.min(axis=0), points_m.max(axis=0)) if len(points_m) else (np.zeros(2), np.ones(2))
        size_m = high - low + 2 * _MARGIN_M
        return cls((low + high) / 2, float((np.array(_SIDE_PX) / size_m).min()))

    def pixels(self, points_m: Floats) -> NDArray[np.int32]:
        """(n, 2) in OpenCV's fixed point; what lies far outside is cut off, as it would overflow."""
        places = np.array(_SIDE_PX) / 2 + self.px_per_m * (points_m - self.centre_m)
        return np.asarray(np.round(np.clip(places, -4000, 4000) * (1 << _SHIFT)), dtype=np.int32)


def _painted(like: NDArray[Any], colour: tuple[int, int, int]) -> NDArray[np.uint8]:
    return np.full((*like.shape, 3), colour, dtype=np.uint8)


def _tile(picture: NDArray[np.uint8], label: str) -> Tile:
    return Tile(data_uri(picture, 101), picture.shape[1], picture.shape[0], label)
