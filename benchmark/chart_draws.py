"""Intervals of medians in charts, from the very draws behind the ranking: one page says one interval of one number."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from benchmark.pool import TRACK
from benchmark.ranking_bootstrap import SHORTEST, Counts, between, bounds, counted, draw
from benchmark.ranking_rule import RESAMPLES, SEED
from benchmark.ranking_table import table_of
from scenes.arrays import Floats

Places = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Draws:
    """``counts`` (frames, draws): how often each draw took each frame of a division, blocks of a track at a time."""

    counts: Counts

    def median_interval(self, errors: Floats, places: Places) -> tuple[float, float]:
        """95 % interval of the median of ``errors`` (n,), which are those of the frames ``places`` (n,) of the division.

        A part of the division's frames is what each draw took of it, which differs in number. Infinite where the bound falls among
        infinite errors; NaN for fewer than three frames.
        """
        if errors.size < SHORTEST:
            return float("nan"), float("nan")
        ascending = np.argsort(errors, kind="stable")
        taken = np.cumsum(self.counts[places[ascending]], axis=0, dtype=np.int64)
        taken = taken[:, taken[-1] > 0]
        middles = ((taken[-1] - 1) // 2, taken[-1] // 2)
        below, above = (errors[ascending][np.count_nonzero(taken <= nth, axis=0)] for nth in middles)
        return bounds(between(below, above, 0.5))


def draws_of(frames: pd.DataFrame) -> tuple[Draws, Places]:
    """The draws that the ranking makes of a division's ``frames``, and of each row which frame of the draws it is."""
    table = table_of(frames)
    counts = np.concatenate(list(counted(draw(table.tracks, RESAMPLES, SEED), RESAMPLES)), axis=1)
    is_short = frames.groupby(TRACK)["frame"].transform("nunique") < SHORTEST
    places = frames.assign(is_short=is_short).groupby(["is_short", *TRACK, "frame"]).ngroup()
    return Draws(counts), np.asarray(places, dtype=np.int64)
