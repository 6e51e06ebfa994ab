"""Markers seen in both views: Shu et al. 2020, end of section 2.3.2 and the fallback of eq. (13)."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.stereo_ring.conics import Ellipse
from estimators.stereo_ring.frame_axes import marker_frame
from estimators.stereo_ring.rig import Rig, epipolar_distance_px, triangulate
from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class MarkerPairs:
    """n matches: pixels ``left_px`` and ``right_px`` (n, 2), ``points_left`` (n, 3) metres; the best matched first."""

    left_px: Floats
    right_px: Floats
    points_left: Floats

    def __len__(self) -> int:
        """How many."""
        return len(self.left_px)


def marker_pairs(rig: Rig, left_px: Floats, right_px: Floats, tolerance_px: float) -> MarkerPairs:
    """All pairs of centroids (n, 2) and (m, 2) that lie on one another's epipolar lines, and in front of the cameras."""
    apart = epipolar_distance_px(rig, left_px[:, None], right_px[None, :])
    i, j = np.nonzero(apart <= tolerance_px)
    points = triangulate(rig, left_px[i], right_px[j])
    ahead = (points[:, 2] > 0) & ((points @ rig.R.T + rig.T)[:, 2] > 0)
    order = np.argsort(apart[i, j], kind="stable")
    order = order[ahead[order]]
    return MarkerPairs(left_px[i][order], right_px[j][order], points[order])


def nearest_to_ring(pairs: MarkerPairs, left: Ellipse, right: Ellipse) -> Floats | None:
    """The marker (3,) nearest to the ring's centre, by the sum of its distances in both pictures; None without markers."""
    if len(pairs) == 0:
        return None
    away = np.linalg.norm(pairs.left_px - left.centre_px, axis=1) + np.linalg.norm(pairs.right_px - right.centre_px, axis=1)
    return np.asarray(pairs.points_left[int(away.argmin())])


def frame_of_markers(pairs: MarkerPairs) -> RigidTransform | None:
    """left_from_markers of the three best matches that share no centroid, eq. (13) mended; None if there are no three."""
    chosen: list[int] = []
    for index in range(len(pairs)):
        others = chosen[:3]
        new = all(
            (pairs.left_px[index] != pairs.left_px[k]).any() and (pairs.right_px[index] != pairs.right_px[k]).any() for k in others
        )
        if new and len(chosen) < 3:
            chosen.append(index)
    return marker_frame(*pairs.points_left[chosen]) if len(chosen) == 3 else None
