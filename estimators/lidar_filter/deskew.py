"""Takes the target's motion during a scan out of its points."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.lidar_filter.clouds import Returns
from scenes.arrays import Floats


def deskewed(returns: Returns, earlier: RigidTransform, later: RigidTransform, span_s: float, reference_s: float) -> Floats:
    """Points (n, 3) in LIDAR axes as if every beam had fired at ``reference_s``, on the clock of ``returns.time_s``.

    ``earlier``, ``later``: lidar_from_target as predicted at two instants ``span_s`` apart. Between them the motion is one screw,
    T(t) = exp(ξ (t − t₀)/span) T(t₀) (Lynch & Park 2017, §3.3), so a point returned at t lies at exp(ξ (t_ref − t)/span) p.
    """
    if span_s <= 0 or not len(returns):
        return returns.points_lidar
    screw = (later * earlier.inv()).as_exp_coords()
    share = (reference_s - returns.time_s) / span_s
    return np.asarray(RigidTransform.from_exp_coords(share[:, None] * screw).apply(returns.points_lidar))
