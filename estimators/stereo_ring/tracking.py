"""The ring from frame to frame: optical flow predicts, the edges measure, the remembered radius judges."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.circle_fit import fit_circle
from estimators.stereo_ring.confirmation import Confirmation
from estimators.stereo_ring.conics import Ellipse
from estimators.stereo_ring.measurement import Measured, Views, measured
from estimators.stereo_ring.optical_flow import FlowSetting, followed_points
from estimators.stereo_ring.parameters import TrackedParameters
from estimators.stereo_ring.rig import Rig

Pictures = tuple[NDArray[np.uint8], NDArray[np.uint8]]
_MARGIN = 1.15  # of the ellipse's major semi-axis, and the flow's window on top: the part in which flow is followed


@dataclass(frozen=True, slots=True, eq=False)
class LastSeen:
    """The last frame in which the ring was measured: its pictures (h, w) of eight bits, and what was found."""

    pictures: Pictures
    measured: Measured


def flow_circle(last: LastSeen, pictures: Pictures, rig: Rig, p: TrackedParameters) -> Circle | None:
    """Where the last circle has gone, by 36 followed points in each view; None if too many were lost."""
    setting = FlowSetting()
    followed = []
    for before, after, ellipse in zip(last.pictures, pictures, last.measured.ellipses, strict=True):
        low, high = _part(ellipse, before.shape, setting.window_px * 2**setting.levels)
        rows, columns = slice(low[1], high[1]), slice(low[0], high[0])
        local = Ellipse(ellipse.x_px - low[0], ellipse.y_px - low[1], ellipse.a_px, ellipse.b_px, ellipse.theta_rad)
        parts = [np.ascontiguousarray(picture[rows, columns]) for picture in (before, after)]
        points = followed_points(parts[0], parts[1], local, setting)
        if len(points) < setting.least_share * setting.points:
            return None
        followed.append(points + low)
    fit = fit_circle(rig, followed[0], followed[1], last.measured.circle, p.track.flow_loss_px)
    return None if fit is None else fit.circle


def tracked_ring(
    views: Views, rig: Rig, starts: Sequence[Circle], inner_share: float | None, memory: Confirmation, p: TrackedParameters
) -> Measured | str:
    """The remembered ring near one of several predictions, the first that will do; or a sentence why none does.

    ``inner_share``: radius of its face's inner edge over that of the outer one, if it has been seen.
    """
    reason = "there is no prediction"
    tries = [(start, windows) for windows in (p.track.windows_px, p.track.wide_windows_px) for start in starts]
    for start, windows in tries:
        found = measured(views, rig, start, windows, p.measure, inner_share=inner_share)
        reason = why_not(found, memory, p)
        if found is not None and not reason:
            return found
    return reason


def why_not(found: Measured | None, memory: Confirmation, p: TrackedParameters) -> str:
    """What speaks against a measurement, or ""."""
    if found is None:
        return "too few edges are near the predicted ring"
    if min(found.share) < p.track.share:
        return f"only {min(found.share):.0%} of the ring's edge is seen, of {p.track.share:.0%} that are needed"
    if max(found.rms_px) > p.track.rms_px:
        return f"its edge scatters by {max(found.rms_px):.2f} px, above {p.track.rms_px:.2f} px"
    if not memory.agrees(found.circle.radius_m, p.track):
        return f"its radius is {found.circle.radius_m:.3f} m, that of the ring {memory.radius_m:.3f} m"
    return ""


def _part(ellipse: Ellipse, shape: tuple[int, ...], room_px: float) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """The square about an ellipse with room for flow, inside a picture (height, width): low and high (u, v)."""
    half = _MARGIN * ellipse.a_px + room_px
    size = np.array([shape[1], shape[0]])
    low = np.clip(np.floor(ellipse.centre_px - half).astype(int), 0, size - 1)
    return low, np.clip(np.ceil(ellipse.centre_px + half).astype(int), low + 1, size)
