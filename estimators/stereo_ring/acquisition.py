"""The ring without a past: ellipses of both views → circles → the one that both views see best → its outermost edge."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.circle_cone import Circle, conics_of_circles
from estimators.stereo_ring.conics import parameters_from_conics
from estimators.stereo_ring.cross_view import Circles, circles_between, circles_through
from estimators.stereo_ring.edge_shares import edge_shares
from estimators.stereo_ring.measurement import Measured, Views, measured
from estimators.stereo_ring.parameters import TrackedParameters
from estimators.stereo_ring.pictures import Smoothed
from estimators.stereo_ring.promotion import promoted
from estimators.stereo_ring.refine import refined
from estimators.stereo_ring.rig import Rig
from estimators.stereo_ring.slopes import Slopes, slopes
from scenes.arrays import Floats

_SAME_PX = 3.0  # two ellipses are one if none of centre and semi-axes differs by more


@dataclass(frozen=True, slots=True, eq=False)
class Acquired:
    """The best circle, or None with the ``reason``; ``ellipses``: how many each view offered."""

    best: Measured | None
    ellipses: tuple[int, int]
    reason: str = ""


def acquired(
    pictures: tuple[NDArray[np.uint8], NDArray[np.uint8]],
    views: Views,
    candidates: tuple[Floats, Floats],
    rig: Rig,
    p: TrackedParameters,
) -> Acquired:
    """``pictures`` (h, w) of eight bits; ``views``: the same, smoothed; ``candidates`` (k, 5): ellipses that a detector offers."""
    good = (good_ellipses(views[0], candidates[0], p), good_ellipses(views[1], candidates[1], p))
    count = (len(good[0]), len(good[1]))
    if not any(count):
        offered = f"{len(candidates[0])} and {len(candidates[1])}"
        return Acquired(None, count, f"none of {offered} ellipses (left, right) lies on an edge all round")
    coarse = (slopes(pictures[0], p.acquire.slope_sigma_px), slopes(pictures[1], p.acquire.slope_sigma_px))
    found = _measured_best(views, _ranked(_circles(good, coarse, rig, p), coarse, views, rig, p), rig, p)
    if found is None:
        return Acquired(None, count, f"{count[0]} and {count[1]} ellipses (left, right) show no circle that both views see")
    return Acquired(promoted(views, rig, found, p), count)


def good_ellipses(view: Smoothed, candidates: Floats, p: TrackedParameters) -> Floats:
    """(k, 5): the candidates (m, 5) refined, those that lie on an edge, each once, the best first."""
    if not len(candidates):
        return np.empty((0, 5))
    fits = refined(view, candidates, p.refine.windows_px, p.refine)
    worth = (fits.share >= p.refine.share) & (fits.rms_px <= p.refine.rms_px)
    order = np.argsort(np.where(worth, 0.3 * fits.rms_px - fits.share, np.inf), kind="stable")[: np.count_nonzero(worth)]
    return _each_once(fits.parameters[order])[: p.acquire.ellipses]


def _each_once(ellipses: Floats) -> Floats:
    """Drops every row (k, ≥4) that is nearly an earlier one."""
    if not len(ellipses):
        return ellipses
    shape = ellipses[:, [0, 1, 2, 3]]
    same = np.abs(shape[:, None] - shape).max(axis=-1) <= _SAME_PX
    keep = np.ones(len(ellipses), dtype=bool)
    for index in range(1, len(ellipses)):  # each depends on what was kept before it
        keep[index] = not (same[index, :index] & keep[:index]).any()
    return ellipses[keep]


def _circles(good: tuple[Floats, Floats], coarse: tuple[Slopes, Slopes], rig: Rig, p: TrackedParameters) -> Circles:
    parts = (
        circles_between(*good, rig, p.acquire),
        circles_through(good[0], 0, rig, coarse[1], p.acquire),
        circles_through(good[1], 1, rig, coarse[0], p.acquire),
    )
    return tuple(np.concatenate(one) for one in zip(*parts, strict=True))  # type: ignore[return-value]


def _ranked(
    circles: Circles, coarse: tuple[Slopes, Slopes], views: Views, rig: Rig, p: TrackedParameters
) -> list[Circle]:
    """The circles with the best look in the view that sees them worse, first coarse, then fine; each once."""
    pictures = [parameters_from_conics(conics_of_circles(*circles, m)) for m in rig.projections]
    support = np.min([s.support(e, p.acquire.full_gradient_dn) for s, e in zip(coarse, pictures, strict=True)], axis=0)
    order = np.argsort(-support, kind="stable")[: p.acquire.looked_at]
    rows = np.column_stack([pictures[0][:, :4], pictures[1][:, :4], *circles])[order]
    share = edge_shares(views, rig, (rows[:, 8:11], rows[:, 11:14], rows[:, 14]), p.acquire.near_px, p.measure.least_gradient_dn)
    once = _each_once_in_both(rows[np.argsort(-share, kind="stable")])[: p.acquire.circles]
    return [Circle(row[8:11], row[11:14], float(row[14])) for row in once]


def _each_once_in_both(rows: Floats) -> Floats:
    """As ``_each_once`` for rows that begin with both views' (x, y, a, b)."""
    keep: list[int] = []
    for index in range(len(rows)):
        if not any(np.abs(rows[index, :8] - rows[other, :8]).max() <= _SAME_PX for other in keep):
            keep.append(index)
    return rows[keep]


def _measured_best(views: Views, circles: list[Circle], rig: Rig, p: TrackedParameters) -> Measured | None:
    found = [measured(views, rig, circle, p.acquire.windows_px, p.measure, fine=False) for circle in circles]
    sound = [one for one in found if one is not None and one.is_within(p.acquire.share, p.acquire.rms_px)]
    if not sound:
        return None
    largest = max(one.circle.radius_m for one in sound)  # of dishes, nozzles and rings, the ring is what all else fits into
    best = max((one for one in sound if one.circle.radius_m >= p.acquire.same_size * largest), key=lambda one: one.support)
    again = measured(views, rig, best.circle, p.acquire.windows_px[-1:], p.measure)
    return again if again is not None and again.is_within(p.acquire.share, p.acquire.rms_px) else None
