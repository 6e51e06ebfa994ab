"""How much of many circles at once lies on edges, in the view that sees them worse."""

import numpy as np

from estimators.stereo_ring.circle_cone import conics_of_circles
from estimators.stereo_ring.conics import parameters_from_conics
from estimators.stereo_ring.cross_view import Circles
from estimators.stereo_ring.edge_peaks import edge_peaks
from estimators.stereo_ring.pictures import Smoothed
from estimators.stereo_ring.refine import stations_on
from estimators.stereo_ring.rig import Rig
from scenes.arrays import Floats

_STATIONS = 120


def edge_shares(views: tuple[Smoothed, Smoothed], rig: Rig, circles: Circles, near_px: float, least_gradient: float) -> Floats:
    """(k,): the share of stations with an edge within ``near_px``, the smaller of both views'; 0 where one sees no ellipse."""
    shares = [_share(view, m, circles, near_px, least_gradient) for view, m in zip(views, rig.projections, strict=True)]
    return np.minimum(shares[0], shares[1])


def _share(view: Smoothed, projection: Floats, circles: Circles, near_px: float, least_gradient: float) -> Floats:
    ellipses = parameters_from_conics(conics_of_circles(*circles, projection))
    real = np.asarray(np.isfinite(ellipses).all(axis=-1))
    stations, normals = stations_on(np.where(real[:, None], ellipses, 1.0), _STATIONS)
    peaks = edge_peaks(view, stations, normals, near_px, least_gradient)
    near = peaks.found & (np.abs(peaks.distance_px) <= near_px)
    return np.where(real, np.mean(near, axis=-1), 0.0)
