"""Where an ellipse of the last frame has gone: 36 of its points followed by pyramidal Lucas-Kanade (Bouguet 2001).

It may say which ellipse to take; as a measurement of its own its error grows by 0.1 to 0.2 px a frame.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.conics import Ellipse, ellipse_from_parameters, points_on_ellipse, radial_deviation
from estimators.stereo_ring.ellipse_fits import direct_fits, point_scatter
from scenes.arrays import Floats

_STEPS, _SMALLEST_STEP_PX = 30, 0.01
_MOST_DEVIATION = 0.1  # relative radial distance from the first fit beyond which a followed point is left out of the second


@dataclass(frozen=True, slots=True)
class FlowSetting:
    """``points`` on the ellipse, side of the square ``window_px``, pyramid ``levels``, the least share to be followed."""

    points: int = 36
    window_px: int = 21
    levels: int = 3
    least_share: float = 0.5


def followed_points(before: NDArray[np.uint8], after: NDArray[np.uint8], ellipse: Ellipse, setting: FlowSetting) -> Floats:
    """Where the ellipse's points are now, (k, 2) px: those that were found again, in two eight-bit pictures of one shape."""
    start = points_on_ellipse(ellipse, setting.points).astype(np.float32)[:, None]
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, _STEPS, _SMALLEST_STEP_PX)
    window = (setting.window_px, setting.window_px)
    moved, status, _ = cv2.calcOpticalFlowPyrLK(
        before, after, start, None, winSize=window, maxLevel=setting.levels - 1, criteria=criteria
    )
    found = moved.reshape(-1, 2).astype(np.float64)
    size = np.array(after.shape[::-1]) - 1
    return np.asarray(found[(status.ravel() == 1) & ((found >= 0) & (found <= size)).all(axis=1)])


def fitted_ellipse(points_px: Floats, setting: FlowSetting) -> Ellipse | None:
    """The ellipse through followed points (k, 2), without those that went elsewhere; None if too few are left."""
    kept = points_px
    fitted: Ellipse | None = None
    for _ in range(2):
        if len(kept) < max(6, setting.least_share * setting.points):
            return None
        (parameters,), _ = direct_fits(*point_scatter(kept[None], np.ones((1, len(kept)))))
        if not np.isfinite(parameters).all():
            return None
        fitted = ellipse_from_parameters(parameters)
        kept = points_px[np.abs(radial_deviation(fitted, points_px)) <= _MOST_DEVIATION]
    return fitted


def mean_deviation(ellipse: Ellipse, points_px: Floats) -> float:
    """Mean relative radial deviation |√((u/a)² + (v/b)²) − 1| of followed points (k, 2); infinite for none.

    Read as pixels, the paper's threshold of 0.05 would refuse every frame; as a share of the radius it lets the right ring pass.
    """
    return float(np.mean(np.abs(radial_deviation(ellipse, points_px)))) if len(points_px) else np.inf
