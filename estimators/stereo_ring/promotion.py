"""From a circle that was found to the outermost edge in its plane about its centre.

A docking ring's face has two edges, and the inner one is often the stronger. The ring's outer edge is asked for; nothing else
on a spacecraft lies in the same plane about the same centre. The inner edge is a second measurement of centre and normal, with
its own neighbours.
"""

import numpy as np

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.edge_shares import edge_shares
from estimators.stereo_ring.measurement import Measured, Views, measured
from estimators.stereo_ring.parameters import TrackedParameters
from estimators.stereo_ring.rig import Rig
from scenes.arrays import Bools, Floats


def promoted(views: Views, rig: Rig, found: Measured, p: TrackedParameters) -> Measured:
    """The outermost edge coplanar and concentric with ``found``, or ``found`` itself if there is none farther out."""
    radii = found.circle.radius_m * np.arange(1 + p.promote.from_share, 1 + p.promote.to_share, p.promote.step_share)
    circles = np.broadcast_to(found.circle.centre_m, (len(radii), 3)), np.broadcast_to(found.circle.normal, (len(radii), 3)), radii
    support = edge_shares(views, rig, circles, p.promote.near_px, p.measure.least_gradient_dn)
    stands_out = _peaks(support) & (support >= max(p.promote.support, float(np.median(support)) + p.promote.above_median))
    best = np.argsort(np.where(stands_out, -support, 0.0), kind="stable")[: p.promote.radii]
    for index in sorted(best[stands_out[best]], reverse=True):
        start = Circle(found.circle.centre_m, found.circle.normal, float(radii[index]))
        edge = measured(views, rig, start, p.promote.windows_px, p.measure)
        if edge is not None and edge.is_within(p.promote.share, p.promote.rms_px) and _is_about(edge.circle, start, p):
            return edge
    return found


def inner_share_of(views: Views, rig: Rig, outer: Measured, p: TrackedParameters) -> float | None:
    """Radius of the best edge inside ``outer``, coplanar and concentric with it, over its radius; None if there is none."""
    radii = outer.circle.radius_m * np.arange(p.promote.inner_from_share, p.promote.inner_to_share, p.promote.step_share)
    circles = np.broadcast_to(outer.circle.centre_m, (len(radii), 3)), np.broadcast_to(outer.circle.normal, (len(radii), 3)), radii
    support = edge_shares(views, rig, circles, p.promote.near_px, p.measure.least_gradient_dn)
    best = int(np.argmax(np.where(_peaks(support), support, 0.0)))
    if support[best] < p.promote.support:
        return None
    start = Circle(outer.circle.centre_m, outer.circle.normal, float(radii[best]))
    edge = measured(views, rig, start, p.promote.windows_px, p.measure, fine=False)
    if edge is None or not edge.is_within(p.promote.inner_share, p.promote.rms_px) or not _is_about(edge.circle, start, p):
        return None
    return edge.circle.radius_m / outer.circle.radius_m


def _peaks(support: Floats) -> Bools:
    padded = np.pad(support, 1)
    return np.asarray((support >= padded[:-2]) & (support > padded[2:]))


def _is_about(edge: Circle, start: Circle, p: TrackedParameters) -> bool:
    """Whether it is still coplanar and concentric with where it began, and about as large."""
    tolerance = p.promote.shift_share * start.radius_m
    tilt = float(np.linalg.norm(np.cross(edge.normal, start.normal)))
    moved = float(np.linalg.norm(edge.centre_m - start.centre_m))
    return moved <= tolerance and tilt <= p.promote.tilt and abs(edge.radius_m - start.radius_m) <= tolerance
