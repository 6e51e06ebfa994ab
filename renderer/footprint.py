"""Which pixels can hold light of the target at all: worth knowing where rays are traced one by one."""

from collections.abc import Iterable

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from scenes.arrays import Floats
from scenes.exr import Window
from scenes.intrinsics import Intrinsics

_SPARE_PX = 2  # rounding, a pixel's own half width and what the target moves within an exposure


def footprint(
    corners_target: Iterable[Floats], cam_from_target: RigidTransform, intrinsics: Intrinsics, window: Window
) -> NDArray[np.bool_]:
    """Pixels of ``window`` (h, w) within the projected convex hull of any part, grown by a few pixels.

    ``corners_target``: for each part the corners (8, 3) of a box around it; every part lies within its hull, so no light
    of it lies outside (lens distortion bends an edge by far less than the margin within one part). A part that reaches
    beside or behind the camera's plane counts as filling the window.
    """
    mask = np.zeros((window.height_px, window.width_px), dtype=np.uint8)
    for corners in corners_target:
        points_cam = cam_from_target.apply(np.array(corners))
        if np.any(points_cam[:, 2] <= 0):
            return np.ones(mask.shape, dtype=np.bool_)
        pixels = intrinsics.project(points_cam) - (window.x_px, window.y_px)
        cv2.fillConvexPoly(mask, cv2.convexHull(np.rint(pixels).astype(np.int32)), 1)
    grown = cv2.dilate(mask, np.ones((2 * _SPARE_PX + 1,) * 2, dtype=np.uint8))
    return np.asarray(grown > 0)
