"""Which of the detected ellipses is the ring: Shu et al. 2020, section 2.3.1, the two steps behind the detector."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.conics import Ellipse
from estimators.stereo_ring.detector import Candidate
from estimators.stereo_ring.optical_flow import fitted_ellipse, followed_points, mean_deviation
from estimators.stereo_ring.paper_parameters import PaperParameters
from estimators.stereo_ring.rig import Rig, epipolar_distance_px


@dataclass(frozen=True, slots=True)
class Choice:
    """The ring's ellipse in one view; ``from_flow``: it is the fit to followed points, no detected ellipse."""

    ellipse: Ellipse
    from_flow: bool = False


def outermost_pair(
    rig: Rig, left: Sequence[Candidate], right: Sequence[Candidate], tolerance_px: float
) -> tuple[Choice, Choice] | None:
    """Step 1: of all pairs whose centres match, the one with the greatest sum of semi-axes."""
    if not left or not right:
        return None
    left_px, right_px = (np.array([one.ellipse.centre_px for one in side]) for side in (left, right))
    matched = epipolar_distance_px(rig, left_px[:, None], right_px[None, :]) <= tolerance_px
    left_size, right_size = (np.array([one.ellipse.a_px + one.ellipse.b_px for one in side]) for side in (left, right))
    size = np.where(matched, left_size[:, None] + right_size[None, :], -np.inf)
    i, j = divmod(int(size.argmax()), len(right))
    return (Choice(left[i].ellipse), Choice(right[j].ellipse)) if matched[i, j] else None


def followed(
    before: NDArray[np.uint8],
    after: NDArray[np.uint8],
    last: Ellipse,
    candidates: Sequence[Candidate],
    parameters: PaperParameters,
) -> Choice | None:
    """Step 2, one view: the ellipse nearest to the followed points, or the fit to them; None if the points are lost."""
    points_px = followed_points(before, after, last, parameters.flow)
    fit = fitted_ellipse(points_px, parameters.flow)
    if fit is None:
        return None
    deviations = [mean_deviation(one.ellipse, points_px) for one in candidates]
    if deviations and min(deviations) <= parameters.max_deviation:
        return Choice(candidates[int(np.argmin(deviations))].ellipse)
    return Choice(fit, from_flow=True)
