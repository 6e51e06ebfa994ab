"""The ring's outer edge in the pictures: the exact ellipse of the true circle, and the one that a method says it measured."""

from collections.abc import Mapping

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.stereo_ring.conics import Ellipse, ellipse_from_conic, points_on_ellipse
from scenes.arrays import Floats
from scenes.features import CircleFeature
from scenes.intrinsics import Intrinsics

RIGHT_PX = 2.0  # an ellipse is the ring's where its centre and semi-axes are all nearer to the true ones than this
PARTS = ("x_px", "y_px", "a_px", "b_px", "theta_rad")
POINTS = 72  # of a drawn circle or ellipse
_EDGE_ON = 1e-9  # sine of the angle between the ring's plane and the line of sight


def true_ellipse(circle: CircleFeature, cam_from_target: RigidTransform, lens: Intrinsics) -> Ellipse | None:
    """The image of the circle in pixels free of distortion; None where it is no ellipse (edge-on, or in part behind the camera).

    With H = K [x y c] of the ring's axes x, y and centre c in camera axes, a point of the ring's plane goes to H (x, y, 1)ᵀ and
    the circle to the conic H⁻ᵀ diag(1, 1, −r²) H⁻¹ (Hartley & Zisserman, Multiple View Geometry, result 2.13).
    """
    cam_from_ring = cam_from_target * circle.target_from_feature
    centre_m, normal = cam_from_ring.translation, cam_from_ring.rotation.apply([0.0, 0.0, 1.0])
    axes = cam_from_ring.rotation.as_matrix()[:, :2]
    reach_m = circle.radius_m * float(np.hypot(*axes[2]))  # how much nearer than the centre the circle comes, along the axis
    if centre_m[2] <= reach_m or abs(normal @ centre_m) < _EDGE_ON * np.linalg.norm(centre_m):
        return None
    inverse = np.linalg.inv(lens.matrix @ np.column_stack([axes, centre_m]))
    return ellipse_from_conic(inverse.T @ np.diag([1.0, 1.0, -(circle.radius_m**2)]) @ inverse)


def measured_ellipse(extras: Mapping[str, float], view: str) -> Ellipse | None:
    """The ellipse of a ``view`` (left, right) in a method's extras, None where it gives none."""
    numbers = [float(extras.get(f"{view}_{part}", np.nan)) for part in PARTS]
    return Ellipse(*numbers) if np.isfinite(numbers).all() else None


def is_the_ring(measured: Ellipse, true: Ellipse | None) -> bool:
    """Whether the centre and both semi-axes agree to ``RIGHT_PX``; a circle that cannot be seen was not measured."""
    if true is None:
        return False
    apart = [getattr(measured, part) - getattr(true, part) for part in PARTS[:4]]
    return bool(np.abs(apart).max() < RIGHT_PX)


def on_ellipse(ellipse: Ellipse, lens: Intrinsics) -> Floats:
    """(n, 2) pixels of the picture on an ellipse that is given in pixels free of distortion."""
    return distorted(points_on_ellipse(ellipse, POINTS), lens)


def distorted(ideal_px: Floats, lens: Intrinsics) -> Floats:
    """(n, 2) pixels of the picture where a lens without distortion would put ``ideal_px``."""
    if not lens.is_distorted:
        return ideal_px
    return lens.pixels_from_normalised((ideal_px - [lens.cx_px, lens.cy_px]) / [lens.fx_px, lens.fy_px])
