"""From the method's own frame to the frame that is answered for, and registrations as named numbers."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.lidar_filter.parameters import LidarParameters
from estimators.lidar_filter.registration import Registration
from scenes.arrays import Floats

_PAPER_R = np.repeat([4e-4, 1.0], 3)  # Song et al. 2017, §5.1: 1e-4 of the quaternion's vector part (half the angle), 1 m²


def stated_covariance(found: Registration, parameters: LidarParameters) -> Floats:
    """Covariance (6, 6) that the filter is told: the registration's own, a fixed one, or Song et al.'s."""
    if parameters.covariance == "adaptive":
        return found.covariance
    if parameters.covariance == "paper":
        return np.diag(_PAPER_R)
    return np.diag(np.repeat([np.deg2rad(parameters.fixed_deg) ** 2, parameters.fixed_m**2], 3))


def filter_extras(extras: dict[str, float], target_from_own: RigidTransform) -> dict[str, float]:
    """The filter's numbers with the centre of mass in the target frame; the own frame has the same axes."""
    shift = dict(zip("xyz", target_from_own.translation, strict=True))
    moved = {f"com_{axis}_m": extras[f"com_{axis}_m"] + float(shift[axis]) for axis in "xyz" if f"com_{axis}_m" in extras}
    return extras | moved


def icp_extras(found: Registration, target_from_own: RigidTransform) -> dict[str, float]:
    """The registration as named numbers: lidar_from_target at the instant that the scan stands for."""
    pose = found.lidar_from_target * target_from_own.inv()
    quaternion = pose.rotation.as_quat(canonical=True, scalar_first=True)
    named = {f"icp_q{axis}": float(value) for axis, value in zip("wxyz", quaternion, strict=True)}
    named |= {f"icp_t{axis}_m": float(value) for axis, value in zip("xyz", pose.translation, strict=True)}
    named |= {"icp_rmse_m": found.rmse_m, "icp_overlap": found.overlap, "icp_points": float(found.points)}
    return named | ({} if np.isnan(found.iterations) else {"icp_iterations": found.iterations})
