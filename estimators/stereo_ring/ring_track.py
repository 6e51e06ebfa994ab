"""The ring in every frame: tracked where it was, else looked for anew; believed or not yet."""

from dataclasses import dataclass

import numpy as np

from estimators.stereo_ring.acquisition import acquired
from estimators.stereo_ring.circle_cone import Circle
from estimators.stereo_ring.confirmation import Confirmation
from estimators.stereo_ring.detector import detect_ellipses
from estimators.stereo_ring.measurement import Measured, Views
from estimators.stereo_ring.parameters import TrackedParameters
from estimators.stereo_ring.pictures import smoothed
from estimators.stereo_ring.promotion import inner_share_of, promoted
from estimators.stereo_ring.rig import Rig
from estimators.stereo_ring.tracking import LastSeen, Pictures, flow_circle, tracked_ring, why_not
from estimators.stopwatch import Stopwatch
from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class RingSeen:
    """``measured``: the ring, or None with the ``reason``; ``believed``: it may be answered; ``is_new``: acquired, not tracked."""

    measured: Measured | None
    believed: bool
    reason: str = ""
    is_new: bool = False


class RingTrack:
    """Memory of one ring: where it was last seen, its radius, whether it is believed."""

    def __init__(self, rig: Rig, parameters: TrackedParameters) -> None:
        """Nothing remembered."""
        self._rig, self._parameters = rig, parameters
        self.memory = Confirmation()
        self._last: LastSeen | None = None
        self._inner_share: float | None = None  # radius of the face's inner edge over that of the outer one
        self._frames = 0  # since the ring was acquired
        self._lost = 0  # frames in a row without it

    def step(self, pictures: Pictures, expected: Circle | None, watch: Stopwatch) -> RingSeen:
        """One frame; ``expected``: the circle where its motion so far would take it."""
        seen = None if self._last is None else self._tracked(pictures, self._last, expected, watch)
        if seen is None or seen.measured is None:
            seen = self._acquired(pictures, seen, watch)
        if seen.measured is None:
            self.memory = self.memory.missed(self._parameters.track)
            self._lost += 1
            if self._lost >= self._parameters.track.forget_frames:
                self.forget()
            return seen
        self._lost = 0
        self._last = LastSeen((pictures[0].copy(), pictures[1].copy()), seen.measured)
        self.memory = self.memory.seen(seen.measured, self._parameters.track)
        return RingSeen(seen.measured, self.memory.believed, is_new=seen.is_new)

    def forget(self) -> None:
        """The next ring may be anywhere and of any size."""
        self.memory, self._last, self._lost = Confirmation(), None, 0

    def _tracked(self, pictures: Pictures, last: LastSeen, expected: Circle | None, watch: Stopwatch) -> RingSeen:
        p = self._parameters
        views = self._views_about(pictures, last.measured)
        flow = flow_circle(last, pictures, self._rig, p)
        watch.ends("track")
        starts = [one for one in (flow, expected, last.measured.circle) if one is not None]
        found = tracked_ring(views, self._rig, starts, self._inner_share, self.memory, p)
        watch.ends("refine")
        if isinstance(found, str):
            return RingSeen(None, False, found)
        self._frames += 1
        if self._frames <= p.track.promote_frames or self._frames % p.track.promote_every == 0:
            found = self._promoted(views, found)
            self._inner_share = found.inner_share or inner_share_of(views, self._rig, found, p)
            watch.ends("promote")
        return RingSeen(found, False)

    def _promoted(self, views: Views, found: Measured) -> Measured:
        """The larger edge, if there is one: the memory was of the inner one, and begins anew."""
        larger = promoted(views, self._rig, found, self._parameters)
        if larger is found:
            return found
        self.memory, self._frames, self._inner_share = Confirmation(), 0, None
        return larger

    def _acquired(self, pictures: Pictures, failed: RingSeen | None, watch: Stopwatch) -> RingSeen:
        p = self._parameters
        views = (smoothed(pictures[0], None, 0.0, p.smooth_sigma_px), smoothed(pictures[1], None, 0.0, p.smooth_sigma_px))
        offered = (self._offered(pictures[0]), self._offered(pictures[1]))
        watch.ends("detect")
        found = acquired(pictures, views, offered, self._rig, p)
        watch.ends("acquire")
        reason = found.reason
        if found.best is not None:
            reason = why_not(found.best, self.memory if self.memory.believed else Confirmation(), p)
        if found.best is None or reason:
            before = f"{failed.reason}; " if failed is not None else ""
            return RingSeen(None, False, before + reason)
        if not self.memory.agrees(found.best.circle.radius_m, p.track):
            self.memory = Confirmation()
        self._frames = 0
        self._inner_share = inner_share_of(views, self._rig, found.best, p)
        again = tracked_ring(views, self._rig, [found.best.circle], self._inner_share, Confirmation(), p)
        watch.ends("acquire")
        return RingSeen(found.best if isinstance(again, str) else again, False, is_new=True)

    def _offered(self, picture: np.ndarray) -> Floats:
        rows = [one.ellipse.parameters for one in detect_ellipses(picture, self._parameters.detector)]
        return np.array(rows).reshape(-1, 5)

    def _views_about(self, pictures: Pictures, last: Measured) -> Views:
        p = self._parameters
        left, right = (
            smoothed(picture, ellipse.centre_px, (p.markers.reach + 0.1) * ellipse.a_px + 20, p.smooth_sigma_px)
            for picture, ellipse in zip(pictures, last.ellipses, strict=True)
        )
        return left, right
