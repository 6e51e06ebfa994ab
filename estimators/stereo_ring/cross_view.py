"""From an ellipse in one view to the circles behind it, by asking the other view at every distance.

One view's cone has two families of circular sections; at a distance z each family gives one circle, whose picture in the other
view is known. Where the other view has an edge all along it, there may be a ring, even if the detector has overlooked it there.
"""

import numpy as np

from estimators.stereo_ring.circle_cone import circles_of_radius, cones_of_conics, conics_of_circles, normals_of_cones
from estimators.stereo_ring.circle_pair import centre_pixels, circles_of_pairs, paired_normals
from estimators.stereo_ring.conics import conics_from_parameters, parameters_from_conics
from estimators.stereo_ring.parameters import AcquireParameters
from estimators.stereo_ring.rig import Rig, epipolar_distance_px
from estimators.stereo_ring.slopes import Slopes
from scenes.arrays import Floats

Circles = tuple[Floats, Floats, Floats]
"""Centres (k, 3), unit normals (k, 3), radii (k,), metres, left camera axes."""


def circles_through(ellipses: Floats, view: int, rig: Rig, other: Slopes, p: AcquireParameters) -> Circles:
    """The best circles behind ellipses (k, 5) of view 0 (left) or 1 (right), as the ``other`` view's slopes see them."""
    if not len(ellipses):
        return np.empty((0, 3)), np.empty((0, 3)), np.empty(0)
    centres, normals, radii = _families(ellipses, view, rig, p)
    conics = conics_of_circles(centres, normals, radii, rig.projections[1 - view])
    support = other.support(parameters_from_conics(conics).reshape(-1, 5), p.full_gradient_dn).reshape(radii.shape)
    support = np.where((radii >= p.least_radius_m) & (radii <= p.most_radius_m), support, 0.0)
    padded = np.pad(support, ((0, 0), (1, 1)))
    peaks = (support > 0) & (support >= padded[:, :-2]) & (support > padded[:, 2:])
    ranked = np.argsort(np.where(peaks, -support, 0.0), axis=1, kind="stable")[:, : p.depths_kept]
    rows = np.repeat(np.arange(len(support)), ranked.shape[1])
    columns = ranked.ravel()
    keep = peaks[rows, columns]
    chosen = rows[keep], columns[keep]
    return centres[chosen], normals[chosen], radii[chosen]


def circles_between(left: Floats, right: Floats, rig: Rig, p: AcquireParameters) -> Circles:
    """The circles behind all pairs of ellipses (k, 5) and (m, 5) that agree on normal, epipolar line and radius."""
    if not len(left) or not len(right):
        return np.empty((0, 3)), np.empty((0, 3)), np.empty(0)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(len(left)), np.arange(len(right)), indexing="ij"))
    conics = conics_from_parameters(left)[i], conics_from_parameters(right)[j]
    normals, gap = paired_normals(rig, *conics)
    with np.errstate(invalid="ignore"):
        epipolar = epipolar_distance_px(rig, *centre_pixels(rig, *conics, normals, "pole"))
        centres, normals, radii = circles_of_pairs(rig, *conics)
        fits = (gap < p.normal_gap) & (epipolar < p.epipolar_px) & (centres[:, 2] > 0)
        fits &= (radii >= p.least_radius_m) & (radii <= p.most_radius_m)
    return centres[fits], normals[fits], radii[fits]


def _families(ellipses: Floats, view: int, rig: Rig, p: AcquireParameters) -> Circles:
    """Circles (2k, depths, ...) of both families at all depths, left camera axes."""
    K = rig.K_left if view == 0 else rig.K_right
    cones = cones_of_conics(conics_from_parameters(ellipses), K)
    normals = normals_of_cones(cones).reshape(-1, 3)
    unit_circle = circles_of_radius(np.repeat(cones, 2, axis=0), normals, np.ones(len(normals)))
    depth = np.geomspace(p.nearest_m, p.farthest_m, p.depths)
    radii = depth / unit_circle[:, 2:]
    centres = unit_circle[:, None] * radii[..., None]
    if view == 1:
        centres, normals = (centres - rig.T) @ rig.R, normals @ rig.R
    return centres, np.broadcast_to(normals[:, None], centres.shape), radii
