"""Lines over a picture as SVG paths: a target's silhouette, a rectangle, a ring and its axes, ellipses, edges."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from benchmark.gallery_window import Window
from benchmark.report_pictures import CYCLIC, outline
from benchmark.ring_ellipses import distorted, measured_ellipse, on_ellipse
from scenes.arrays import Floats
from scenes.features import CircleFeature, Feature, RectangleFeature
from scenes.intrinsics import Intrinsics
from scenes.solids import Solid

_SHIFT = 4  # bits of a pixel's fraction in OpenCV's drawing
_CANVAS_PX, _FAR_PX = 720, 30000  # of a silhouette: across; beyond, OpenCV's fixed point would overflow
_FINEST_PX, _SPECK_PX2 = 0.4, 6.0  # of the canvas: what a contour may leave out
_EDGES = ("p1p2", "p3p4", "p1p3", "p2p4")


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A line in a window's SVG coordinates. ``kind``: true, answered or detected. ``path``: the attribute d of an SVG path."""

    kind: str
    path: str


def silhouette(solids: Iterable[Solid], cam_from_target: RigidTransform, lens: Intrinsics, window: Window) -> str:
    """The outline of the target's triangles at a pose, with its holes, as far as it lies in the window.

    Triangles that are not wholly in front of the camera are left out.
    """
    scale = min(4.0, _CANVAS_PX / window.width)
    canvas = np.zeros((max(1, round(window.height * scale)), max(1, round(window.width * scale))), dtype=np.uint8)
    for solid in solids:
        places = window.svg(lens.project(cam_from_target.apply(solid.vertices_target))) * scale - 0.5
        _fill(canvas, places[solid.faces])
    edged = cv2.copyMakeBorder(canvas, 1, 1, 1, 1, cv2.BORDER_REPLICATE)  # so that where the window cuts, no line is seen
    contours, _ = cv2.findContours(edged, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    kept = [cv2.approxPolyDP(one, _FINEST_PX, True)[:, 0] for one in contours if cv2.contourArea(one) > _SPECK_PX2]
    return " ".join(closed((one - 0.5) / scale) for one in kept)


def _fill(canvas: NDArray[np.uint8], triangles: Floats) -> None:
    """Sets the pixels of (n, 3, 2) triangles that show their outside, integers being pixel centres; smaller ones are points."""
    there = triangles[np.isfinite(triangles).all(axis=(1, 2))]
    (x1, y1), (x2, y2) = (there[:, 1] - there[:, 0]).T, (there[:, 2] - there[:, 0]).T
    there = there[x1 * y2 < x2 * y1]  # surfaces are one-sided: with y down, those that face the camera run clockwise
    low, high = there.min(axis=1, initial=np.inf), there.max(axis=1, initial=-np.inf)
    inside = (high > -1).all(axis=1) & (low < np.array(canvas.shape[::-1])).all(axis=1)
    inside &= (low > -_FAR_PX).all(axis=1) & (high < _FAR_PX).all(axis=1)
    fine = inside & ((high - low) < 1.0).all(axis=1)
    columns, rows = np.round(there[fine].reshape(-1, 2)).astype(np.int64).T
    canvas[np.clip(rows, 0, canvas.shape[0] - 1), np.clip(columns, 0, canvas.shape[1] - 1)] = 255
    for triangle in np.round(there[inside & ~fine] * (1 << _SHIFT)).astype(np.int32):
        cv2.fillConvexPoly(canvas, triangle, 255, cv2.LINE_8, _SHIFT)


def feature_points(feature: Feature) -> Floats:
    """(n, 3) around a feature, target frame, metres: a rectangle's corners, a circle, a marker's centre."""
    points = outline(feature)
    return points[CYCLIC] if isinstance(feature, RectangleFeature) else points


def outlined(feature: Feature, cam_from_target: RigidTransform, lens: Intrinsics, window: Window) -> str:
    """A feature's outline at a pose; of a ring also the axis towards its marker and its normal, each a radius long."""
    outline = closed(window.svg(lens.project(cam_from_target.apply(feature_points(feature)))))
    if not isinstance(feature, CircleFeature):
        return outline
    cam_from_ring = cam_from_target * feature.target_from_feature
    ends = lens.project(cam_from_ring.apply(feature.radius_m * np.array([(0, 0, 0), (1, 0, 0), (0, 0, 1)])))
    foot, *tips = window.svg(ends)
    return " ".join([outline, *(stroke(np.stack([foot, tip])) for tip in tips)]).strip()


def detected(extras: Mapping[str, float], view: str, lens: Intrinsics, window: Window) -> str:
    """What a method says it found: a ring's ellipse, a rectangle's edges or corners, in ideal pixels; empty where it says nothing.

    ``view``: left or right of an ellipse. Edges are ``p1p2_x0_px p1p2_y0_px p1p2_x1_px p1p2_y1_px`` …, corners ``p1_x_px`` ….
    """
    ellipse = measured_ellipse(extras, view)
    paths = [] if ellipse is None else [closed(window.svg(on_ellipse(ellipse, lens)))]
    for edge in _EDGES:
        ends = _pair(extras, f"{edge}_x0_px", f"{edge}_y0_px", f"{edge}_x1_px", f"{edge}_y1_px")
        paths.append(stroke(window.svg(distorted(ends, lens))))
    corners = _pair(extras, *(f"p{corner + 1}_{axis}_px" for corner in CYCLIC for axis in "xy"))
    paths.append(closed(window.svg(distorted(corners, lens))))
    return " ".join(path for path in paths if path)


def _pair(extras: Mapping[str, float], *names: str) -> Floats:
    """(n, 2) of the named numbers, NaN where one is missing."""
    return np.array([float(extras.get(name, np.nan)) for name in names]).reshape(-1, 2)


def closed(points: Floats) -> str:
    """A closed path; empty where a point lies nowhere."""
    path = stroke(points)
    return f"{path}Z" if path else ""


def stroke(points: Floats) -> str:
    """An open path; empty where a point lies nowhere or too far away to be drawn."""
    if not len(points) or not np.isfinite(points).all() or np.abs(points).max() > _FAR_PX:
        return ""
    return "M" + " ".join(f"{x:.1f},{y:.1f}" for x, y in points + 0.0)
