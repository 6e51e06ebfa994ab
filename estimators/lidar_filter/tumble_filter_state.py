"""State of the recommended filter: everything in the target's own axes, so that no axis of it needs a label.

Twenty errors: attitude θ (inertial_from_target = estimate · exp(θ)), ω, j, then r and v in the chaser's orbital frame, and ρ; after
them six of the measurement, which are zero where a method says nothing of a drift. All arrays may have a leading axis.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats
from scenes.inertia import components_of, inertia_of

ATTITUDE, OMEGA, INERTIA = slice(0, 3), slice(3, 6), slice(6, 11)
POSITION, VELOCITY, OFFSET = slice(11, 14), slice(14, 17), slice(17, 20)
ROTATION, TRANSLATION = slice(0, 11), slice(11, 17)
DRIFT_ATTITUDE, DRIFT_POSITION, DRIFT = slice(20, 23), slice(23, 26), slice(20, 26)
STATES, ALL = 20, 26
_MOST_OF_ONE = np.sqrt(2 / 3)  # no eigenvalue of Σ j_i E_i is more than this share of |j|, as there is no trace


@dataclass(frozen=True, slots=True, eq=False)
class TumbleState:
    """What is known of the target at ``time_s``.

    ``omega_rad_s`` (..., 3): inertial angular velocity, target axes. ``inertia`` (..., 5): j of J = 1 + Σ j_i E_i.
    ``position_m``, ``velocity_m_s`` (..., 3): centre of mass relative to the chaser's, in its orbital frame. ``offset_m``
    (..., 3): ρ, from the centre of mass to the target frame's origin, target axes. ``drift`` (..., 6): the lasting error of
    measurements, rotation vector in target axes and position in LIDAR axes; ``drift_spread`` (..., 6, 6): its covariance over
    a long time. ``covariance`` (..., 26, 26) of the errors.
    """

    time_s: float
    inertial_from_target: Rotation
    omega_rad_s: Floats
    inertia: Floats
    position_m: Floats
    velocity_m_s: Floats
    offset_m: Floats
    drift: Floats
    drift_spread: Floats
    covariance: Floats

    @property
    def J(self) -> Floats:
        """Inertia (..., 3, 3) in target axes, scaled to trace 3."""
        return inertia_of(self.inertia)

    def corrected(self, error: Floats, covariance: Floats, least_moment: float) -> "TumbleState":
        """With estimated errors (..., 26) taken out; an inertia that no body comes near is brought back."""
        return TumbleState(
            self.time_s,
            self.inertial_from_target * Rotation.from_rotvec(error[..., ATTITUDE]),
            self.omega_rad_s + error[..., OMEGA],
            bounded(self.inertia + error[..., INERTIA], least_moment),
            self.position_m + error[..., POSITION],
            self.velocity_m_s + error[..., VELOCITY],
            self.offset_m + error[..., OFFSET],
            self.drift + error[..., DRIFT],
            self.drift_spread,
            covariance,
        )


def bounded(inertia: Floats, least_moment: float) -> Floats:
    """j (..., 5) with the principal moments of J lifted to ``least_moment`` where they are less, trace 3."""
    length = np.sqrt((inertia * inertia).sum(axis=-1).max())
    if not length * _MOST_OF_ONE > 1 - least_moment:  # also where it is no number: the filter says so itself
        return inertia
    moments, axes = np.linalg.eigh(inertia_of(inertia))
    if moments.min() >= least_moment:
        return inertia
    lifted = np.maximum(moments, least_moment)
    return components_of((axes * lifted[..., None, :]) @ axes.swapaxes(-1, -2))
