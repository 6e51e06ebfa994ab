"""Regular markers as connected regions: Shu et al. 2020, section 2.3.2 and eqs (6) and (7).

The paper's two passes over the picture give 4-connected components, which OpenCV's labelling gives too. "Curvature" ρ is a fill
ratio. As printed, its bounding box is one pixel short in both directions, so that a square along the pixels has ρ > 1 and is
refused; ``box_extra_px`` = 1 counts the pixels, 0 is the print.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats


@dataclass(frozen=True, slots=True)
class RegionLimits:
    """Least and most of grey (DN), area (px), fill ratio ρ and height over width η of a region that may be a marker."""

    grey_dn: tuple[int, int] = (1, 60)
    area_px: tuple[float, float] = (200.0, 3000.0)
    fill: tuple[float, float] = (0.5, 1.0)
    aspect: tuple[float, float] = (0.7, 1.5)
    box_extra_px: int = 1


def marker_centres(picture: NDArray[np.uint8], limits: RegionLimits) -> Floats:
    """Centroids (n, 2) px, eq. (7), of the regions of an eight-bit picture (height, width) that keep all limits."""
    mask = np.asarray(cv2.inRange(picture, *limits.grey_dn), dtype=np.uint8)
    _, _, boxes, centroids = cv2.connectedComponentsWithStats(mask, connectivity=4, ltype=cv2.CV_32S)
    kept = np.flatnonzero(_regular(boxes, limits))
    return np.asarray(centroids[kept[kept > 0]], dtype=np.float64)  # the first component is the background


def fill_and_aspect(area_px: Floats, width_px: Floats, height_px: Floats, box_extra_px: int = 1) -> tuple[Floats, Floats]:
    """ρ and η (n,) of eq. (6), of regions with these areas and numbers of columns and rows (n,)."""
    across, down = width_px - 1 + box_extra_px, height_px - 1 + box_extra_px
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(area_px / (across * down)), np.asarray(down / across)


def _regular(boxes: NDArray[np.int32], limits: RegionLimits) -> NDArray[np.bool_]:
    area, width, height = (
        boxes[:, column].astype(np.float64) for column in (cv2.CC_STAT_AREA, cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT)
    )
    fill, aspect = fill_and_aspect(area, width, height, limits.box_extra_px)
    within = [_between(area, limits.area_px), _between(fill, limits.fill), _between(aspect, limits.aspect)]
    return np.asarray(np.logical_and.reduce(within))


def _between(values: Floats, ends: tuple[float, float]) -> NDArray[np.bool_]:
    return np.asarray((values >= ends[0]) & (values <= ends[1]))
