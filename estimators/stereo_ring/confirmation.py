"""When a ring is believed: at once where the evidence is overwhelming, else when it is there in two of three frames.

And what is remembered of it then: its radius, which no shadow and no inner edge shares.
"""

from dataclasses import dataclass, replace

from estimators.stereo_ring.measurement import Measured
from estimators.stereo_ring.parameters import TrackParameters


@dataclass(frozen=True, slots=True)
class Confirmation:
    """``hits``: the last frames, whether the ring was there; ``believed``; ``radius_m`` and over how many frames it is the mean."""

    hits: tuple[bool, ...] = ()
    believed: bool = False
    radius_m: float = 0.0
    count: int = 0

    def agrees(self, radius_m: float, p: TrackParameters) -> bool:
        """Whether a radius is that of the remembered ring (anything, if there is none)."""
        return self.count == 0 or abs(radius_m / self.radius_m - 1) <= p.radius_share

    def seen(self, measured: Measured, p: TrackParameters) -> "Confirmation":
        """After a frame in which the ring was there."""
        hits = (*self.hits, True)[-p.confirm_of :]
        overwhelming = measured.is_within(p.believe_share, p.believe_rms_px)
        count = min(self.count + 1, p.radius_frames)
        radius_m = self.radius_m + (measured.circle.radius_m - self.radius_m) / count
        return Confirmation(hits, self.believed or overwhelming or sum(hits) >= p.confirm, radius_m, count)

    def missed(self, p: TrackParameters) -> "Confirmation":
        """After a frame without it: what was never believed is forgotten once it cannot be any more."""
        hits = (*self.hits, False)[-p.confirm_of :]
        if not self.believed and sum(hits) == 0:
            return Confirmation()
        return replace(self, hits=hits)
