"""How far predictions carry over scans of which nothing was used.

A scan may say nothing (too few returns, or of a side that the reference does not hold), or contradict: it has returns enough and
still cannot be laid where the prediction has the target, or lies farther from it than both allow. Of 10000 scans of song2017
against a model 26 were refused as too far, at most two in a row, and all could be laid: three in a row are a track that is lost.
"""

from dataclasses import dataclass

import numpy as np

from estimators.lidar_filter.parameters import TrackParameters


@dataclass(slots=True)
class Bridge:
    """Counts of one track's scans: ``used`` so far; since the last of them ``unused``, ``contradicting``, ``unregistered``."""

    used: int = 0
    unused: int = 0
    contradicting: int = 0
    unregistered: int = 0

    def follows(self) -> None:
        """A scan was used."""
        self.used += 1
        self.unused = self.contradicting = self.unregistered = 0

    def misses(self, contradicts: bool, is_registered: bool) -> None:
        """Nothing of a scan was used."""
        self.unused += 1
        self.contradicting += contradicts
        self.unregistered += contradicts and not is_registered

    def is_contradicted(self, parameters: TrackParameters) -> bool:
        """Whether as many scans in a row contradict as show a lost track, or as were ever used: then neither is the outlier."""
        return self.contradicting >= max(1, min(parameters.lost_after, self.used))

    def breaks(self, sigma: tuple[float, float], parameters: TrackParameters) -> str:
        """Why a prediction is no answer, or nothing; ``sigma``: its 1σ of attitude (rad) and position (m), largest axis.

        A scan that does not fit at all is believed at once, as no good one was like that. Refused registrations lie near by and are
        left to the filter, which comes to doubt itself.
        """
        sigma_deg, sigma_m = np.rad2deg(sigma[0]), sigma[1]
        if self.unregistered:
            return f"{self.unregistered} of the last {self.unused} scans do not fit where the target is predicted"
        if self.unused >= self.used:
            return f"no prediction over {self.unused} scans rests on {self.used}"
        if sigma_deg > parameters.predicted_deg or sigma_m > parameters.predicted_m:
            return f"after {self.unused} scans the prediction is known to {sigma_deg:.1f}° and {sigma_m:.2f} m (1σ)"
        return ""
