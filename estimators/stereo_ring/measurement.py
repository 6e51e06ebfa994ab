"""One circle in space, measured in both views at once: edge points about its two ellipses, one joint fit, ever narrower.

Two ellipses fitted apart have ten freedoms and follow whatever lies nearby; the circle has six, so that the edge of a wall, of
a shadow or of the inside, which the other view sees elsewhere, does not pull it. What counts as support is an edge near the
*joint* circle's picture in the view.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimators.stereo_ring.circle_cone import Circle, conics_of_circles
from estimators.stereo_ring.circle_fit import CirclesFit, fit_circles
from estimators.stereo_ring.conics import Ellipse, ellipse_from_conic, ellipse_from_parameters, parameters_from_conics, sampson_px
from estimators.stereo_ring.edge_peaks import edge_peaks
from estimators.stereo_ring.parameters import MeasureParameters
from estimators.stereo_ring.pictures import Smoothed
from estimators.stereo_ring.refine import scaled_window, stations_on
from estimators.stereo_ring.rig import Rig
from scenes.arrays import Floats

Views = tuple[Smoothed, Smoothed]
Pair = tuple[Floats, Floats]


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """A circle with what speaks for it: per view the ellipse, the share of stations with an edge near it, and those edges' rms."""

    fit: CirclesFit
    ellipses: tuple[Ellipse, Ellipse]
    share: tuple[float, float]
    rms_px: tuple[float, float]

    @property
    def circle(self) -> Circle:
        """The circle itself, left camera axes."""
        return self.fit.circle

    @property
    def inner_share(self) -> float | None:
        """Radius of the inner edge over that of the outer one, if both were measured."""
        return float(self.fit.radii_m[1] / self.fit.radii_m[0]) if len(self.fit.radii_m) > 1 else None

    @property
    def support(self) -> float:
        """The smaller of the two shares, less for a loose fit: what hypotheses are ranked by."""
        return min(self.share) - 0.3 * max(self.rms_px)

    def is_within(self, share: float, rms_px: float) -> bool:
        """Whether both views see at least this share, scattering by no more than this."""
        return min(self.share) >= share and max(self.rms_px) <= rms_px


def measured(
    views: Views,
    rig: Rig,
    start: Circle,
    windows_px: Sequence[float],
    p: MeasureParameters,
    fine: bool = True,
    inner_share: float | None = None,
) -> Measured | None:
    """The edge near ``start``, searched in ``windows_px`` to both sides; None where the fit leaves the picture.

    ``fine``: all stations in the last window; without, an answer that is good enough to choose by. ``inner_share``: radius of
    the face's inner edge over that of the outer one, where it is known: it is measured along.
    """
    circle, fit = start, None
    radii = [start.radius_m] if inner_share is None else [start.radius_m, inner_share * start.radius_m]
    for number, window in enumerate(windows_px, 1):
        last = number == len(windows_px)
        count = p.stations if last and fine else p.coarse_stations
        edges = [_edges_of(views, rig, replace(circle, radius_m=radius), window, count, p) for radius in radii]
        fit = _trimmed_fit(rig, edges, circle, radii, p, trims=last * (p.trims if fine else 1))
        if fit is None:
            return None
        circle, radii = fit.circle, [float(radius) for radius in fit.radii_m]
    return None if fit is None else judged(views, rig, fit, p)


def _edges_of(views: Views, rig: Rig, circle: Circle, window_px: float, count: int, p: MeasureParameters) -> Pair:
    """Edge points (n, 2) and (m, 2) px about one circle in both views."""
    left, right = (
        _edges(view, conics_of_circles(circle.centre_m, circle.normal, circle.radius_m, projection), window_px, count, p)
        for view, projection in zip(views, rig.projections, strict=True)
    )
    return left, right


def _trimmed_fit(
    rig: Rig, edges: list[Pair], start: Circle, radii_m: list[float], p: MeasureParameters, trims: int
) -> CirclesFit | None:
    """The joint fit, repeated without the points that are far from it: edges of other things lie to one side and would pull."""
    kept, fit = edges, None
    for trim in range(trims + 1):
        if trim and fit is not None:
            start, radii_m = fit.circle, [float(radius) for radius in fit.radii_m]
            kept = [_kept(pair, rig, replace(start, radius_m=r), p) for pair, r in zip(edges, radii_m, strict=True)]
        if min(len(points) for points in kept[0]) < p.least_points:
            return None
        fit = fit_circles(rig, kept, start, radii_m, p.loss_px, p.fit_step)
        if fit is None:
            return None
    return fit


def _edges(view: Smoothed, conic: Floats, window_px: float, count: int, p: MeasureParameters) -> Floats:
    """Edge points (n, 2) px about one conic (3, 3); none if it is no ellipse."""
    ellipse = parameters_from_conics(conic)
    if not np.isfinite(ellipse).all():
        return np.empty((0, 2))
    stations, normals = stations_on(ellipse, count)
    reach = float(scaled_window(window_px, ellipse[2]))
    peaks = edge_peaks(view, stations, normals, reach, p.least_gradient_dn)
    return np.asarray((stations + peaks.distance_px[:, None] * normals)[peaks.found])


def _kept(pair: Pair, rig: Rig, circle: Circle, p: MeasureParameters) -> Pair:
    """Without the points farther from the circle than a multiple of their robust scatter in their view."""
    kept = []
    for points, projection in zip(pair, rig.projections, strict=True):
        distance = np.abs(sampson_px(conics_of_circles(circle.centre_m, circle.normal, circle.radius_m, projection), points))
        scale = 1.4826 * float(np.median(distance)) if distance.size else 0.0
        kept.append(np.asarray(points[distance <= np.clip(p.trim_sigmas * scale, p.trim_px, p.trim_most_px)]))
    return kept[0], kept[1]


def seen_ellipses(circle: Circle, rig: Rig) -> tuple[Ellipse, Ellipse] | None:
    """How both views see a circle; None if not as ellipses."""
    conics = [conics_of_circles(circle.centre_m, circle.normal, circle.radius_m, m) for m in rig.projections]
    left, right = (ellipse_from_conic(conic) for conic in conics)
    return None if left is None or right is None else (left, right)


def judged(views: Views, rig: Rig, fit: CirclesFit, p: MeasureParameters) -> Measured | None:
    """What the views say to a circle that has been fitted."""
    circle = fit.circle
    shares, scatters, ellipses = [], [], []
    for view, projection in zip(views, rig.projections, strict=True):
        conic = conics_of_circles(circle.centre_m, circle.normal, circle.radius_m, projection)
        parameters = parameters_from_conics(conic)
        if not np.isfinite(parameters).all():
            return None
        distance = np.abs(sampson_px(conic, _edges(view, conic, p.judge_window_px, p.judge_stations, p)))
        near = distance[distance <= p.near_px]
        shares.append(near.size / p.judge_stations)
        within = distance[distance <= p.rms_within_px]
        scatters.append(float(np.sqrt(np.mean(within**2))) if within.size else float("inf"))
        ellipses.append(ellipse_from_parameters(parameters))
    return Measured(fit, (ellipses[0], ellipses[1]), (shares[0], shares[1]), (scatters[0], scatters[1]))
