"""One circle from its two ellipses: Shu et al. 2020, eq. (12) mended, and where its centre is.

Eq. (12) prints n_r = R ζ_r; with R from left to right, as (2) needs it, the right normals come back by Rᵀ. Of the four pairs
the closest is the circle's, once all normals look at the camera; its mean has to be made a unit vector again.

The paper never says how X0 is obtained, but matches the ellipses' centres, whose triangulation (``ellipse_centre``) is off
towards the far side by 2 r² tan(toe-in)/baseline, 18 cm for its rig, at every distance. ``pole`` is the image of the centre.
"""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from estimators.stereo_ring.circle_cone import Circle, cones_of_conics, normals_of_cones, poles_of_planes, radii_at
from estimators.stereo_ring.conics import parameters_from_conics
from estimators.stereo_ring.rig import Rig, triangulate
from scenes.arrays import Floats

CentreMode = Literal["ellipse_centre", "pole"]


def circle_of_pair(rig: Rig, left_conic: Floats, right_conic: Floats, centre_mode: CentreMode = "pole") -> Circle | None:
    """The circle behind two conics (3, 3); None if they are no two ellipses of one circle in front of the rig."""
    centre, normal, radius = circles_of_pairs(rig, left_conic, right_conic, centre_mode)
    if not (np.isfinite(centre).all() and np.isfinite(normal).all() and np.isfinite(radius)):
        return None
    return Circle(centre, normal, float(radius)) if centre[2] > 0 else None


def circles_of_pairs(
    rig: Rig, left_conics: ArrayLike, right_conics: ArrayLike, centre_mode: CentreMode = "pole"
) -> tuple[Floats, Floats, Floats]:
    """Centres (..., 3), normals (..., 3), radii (...,) of circles seen as C (..., 3, 3) in both views; NaN where there is none.

    The radius is the mean of what the two cones say for this centre and normal.
    """
    normals, _ = paired_normals(rig, left_conics, right_conics)
    left_px, right_px = centre_pixels(rig, left_conics, right_conics, normals, centre_mode)
    centres = triangulate(rig, left_px, right_px)
    left = radii_at(cones_of_conics(left_conics, rig.K_left), normals, centres)
    right = radii_at(cones_of_conics(right_conics, rig.K_right), normals @ rig.R.T, centres @ rig.R.T + rig.T)
    return centres, normals, np.asarray((left + right) / 2)


def paired_normals(rig: Rig, left_conics: ArrayLike, right_conics: ArrayLike) -> tuple[Floats, Floats]:
    """Unit normals (..., 3) in left axes, eq. (12) mended, and the gaps (...,) |n_r − n_l| of the chosen pairs."""
    left = normals_of_cones(cones_of_conics(left_conics, rig.K_left))
    right = normals_of_cones(cones_of_conics(right_conics, rig.K_right)) @ rig.R
    gaps = np.linalg.norm(left[..., :, None, :] - right[..., None, :, :], axis=-1)
    flat = gaps.reshape(*gaps.shape[:-2], 4)
    choice = np.argmin(np.nan_to_num(flat, nan=np.inf), axis=-1)
    sums = (left[..., :, None, :] + right[..., None, :, :]).reshape(*flat.shape, 3)
    total = np.take_along_axis(sums, choice[..., None, None], axis=-2)[..., 0, :]
    gap = np.take_along_axis(flat, choice[..., None], axis=-1)[..., 0]
    return total / np.linalg.norm(total, axis=-1, keepdims=True), gap


def centre_pixels(
    rig: Rig, left_conics: ArrayLike, right_conics: ArrayLike, normals: ArrayLike, centre_mode: CentreMode
) -> tuple[Floats, Floats]:
    """Pixels (..., 2) taken for the centre's image in both views; ``normals`` (..., 3) in left axes."""
    if centre_mode == "ellipse_centre":
        return parameters_from_conics(left_conics)[..., :2], parameters_from_conics(right_conics)[..., :2]
    in_right = np.asarray(normals) @ rig.R.T
    return poles_of_planes(left_conics, rig.K_left, normals), poles_of_planes(right_conics, rig.K_right, in_right)
