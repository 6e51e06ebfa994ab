"""The paired bootstrap behind rankings: frames drawn in blocks, the same for all methods, and statistics of all draws at once.

A draw is kept as how often it took each frame, a column of a (frames, draws) table of counts. A mean over a draw is then a
product with that table, and a quantile a place in the cumulative counts of the sorted values, so nothing loops over draws.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats

Counts = NDArray[np.uint16]
CONFIDENCE = 0.95
SHORTEST = 3  # frames: a block of a shorter track is always the whole track
_AT_ONCE = 250  # draws, which bounds the memory: 20 000 frames of them take 10 MB
_ROWS = 4096


@dataclass(frozen=True, slots=True)
class Track:
    """One sensor's ``frames`` successive frames on one subject of ``run``, drawn in blocks of ``length`` frames.

    Tracks of one run show the same pictures.
    """

    run: str
    frames: int
    length: int


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Where a track's blocks start in each draw, ``starts`` (draws, blocks), and how long a block is, in frames."""

    frames: int
    length: int
    starts: NDArray[np.int64]

    def counts(self, first: int, last: int) -> Counts:
        """(frames, last − first): how often each of these draws took each frame; each takes as many as there are."""
        draws = last - first
        chosen = (self.starts[first:last, :, None] + np.arange(self.length)) % self.frames
        chosen = chosen.reshape(draws, -1)[:, : self.frames]
        flat = chosen * draws + np.arange(draws)[:, None]
        return np.bincount(flat.ravel(), minlength=self.frames * draws).astype(np.uint16).reshape(self.frames, draws)


def block_length(series: Floats) -> int:
    """How many frames a block of a track of n needs, for means of ``series`` (n, k): ⌈n^(1/3)⌉, or more where errors drift.

    (3/2 G² n)^(1/3) with G = Σ|k| ρ_k / Σ ρ_k minimises the error of the mean's variance (Politis & White 2004, equation 9 with
    the circular bootstrap's D = 4/3 g(0)²); of a first-order process with neighbours correlated by ρ, G = 2ρ/(1 − ρ²), and ρ is the
    series' own (Andrews 1991). The largest of all series counts, up to a third of the track.
    """
    frames, centred = len(series), series - series.mean(axis=0)
    power = np.sum(centred**2, axis=0)
    together = np.sum(centred[1:] * centred[:-1], axis=0)
    correlation = np.clip(np.divide(together, power, out=np.zeros_like(power), where=power > 0), 0.0, 0.999)
    drift = float(np.max(2 * correlation / (1 - correlation**2)))
    least, wanted = np.ceil(np.round([frames ** (1 / 3), (1.5 * drift**2 * frames) ** (1 / 3)], 9))
    return int(max(least, min(wanted, frames // 3)))


def draw(tracks: Sequence[Track], draws: int, seed: int) -> list[Blocks]:
    """Circular blocks of successive frames within each track (Politis & Romano 1992), all tracks kept.

    Neighbouring frames err alike; blocks keep that. The stream of random numbers is the seed's and the run's: tracks of one run
    draw the same frames, and what other tracks there are changes nothing. Tracks too short for two blocks, which come last in
    ``tracks``, are drawn from as one.
    """
    short = sum(track.frames for track in tracks if track.frames < SHORTEST)
    strands = [track for track in tracks if track.frames >= SHORTEST] + (
        [Track("", short, block_length(np.zeros((short, 1))))] if short else []
    )
    blocks = []
    for strand in strands:
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(crc32(strand.run.encode()),)))
        starts = rng.integers(strand.frames, size=(draws, -(-strand.frames // strand.length)))
        blocks.append(Blocks(strand.frames, strand.length, starts))
    return blocks


def counted(blocks: Sequence[Blocks], draws: int) -> Iterator[Counts]:
    """The tables of counts of all tracks one below the other, some draws at a time."""
    for first in range(0, draws, _AT_ONCE):
        last = min(first + _AT_ONCE, draws)
        yield np.concatenate([one.counts(first, last) for one in blocks])


def sums(counts: Counts, values: Floats) -> Floats:
    """(draws, k) sums over each draw of ``values`` (n, k)."""
    total = np.zeros((counts.shape[1], values.shape[1]))
    for first in range(0, len(values), _ROWS):
        total += counts[first : first + _ROWS].T.astype(np.float64) @ values[first : first + _ROWS]
    return total


def quantiles(counts: Counts, values: Floats, levels: Sequence[float]) -> Floats:
    """(draws, levels) quantiles of ``values`` (n,) over each draw; infinite where one falls among infinite values.

    Those of ``numpy.quantile``: between the two neighbours of place q (n − 1). Values are counted in coarse bins first, then one
    by one in the bin concerned.
    """
    ascending = np.argsort(values, kind="stable")
    ordered, sorted_ = np.take(counts, ascending, axis=0), values[ascending]
    width = int(np.sqrt(len(values)))
    bins = len(values) // width  # what is left over needs no sum: it is looked into where the bins do not suffice
    cumulative = ordered[: bins * width].reshape(bins, width, -1).sum(axis=1, dtype=np.int64).cumsum(axis=0)
    columns = []
    for level in levels:
        place = level * (len(values) - 1)
        below, above = (sorted_[_nth(ordered, cumulative, width, int(n))] for n in (np.floor(place), np.ceil(place)))
        columns.append(between(below, above, place % 1.0))
    return np.stack(columns, axis=1)


def plain_quantiles(values: Floats, levels: Sequence[float]) -> Floats:
    """(levels,) quantiles of ``values`` (n,) as they are, each once."""
    return np.asarray(quantiles(np.ones((len(values), 1), dtype=np.uint16), values, levels)[0])


def _nth(ordered: Counts, cumulative: NDArray[np.int64], width: int, n: int) -> NDArray[np.int64]:
    """(draws,) where in the sorted values the ``n``-th (from 0) of each draw is."""
    each = np.arange(ordered.shape[1])
    inside = np.count_nonzero(cumulative <= n, axis=0)
    before = np.where(inside > 0, cumulative[inside - 1, each], 0)
    places = np.minimum(inside * width + np.arange(width)[:, None], len(ordered) - 1)
    passed = np.cumsum(ordered[places, each], axis=0, dtype=np.int64) <= n - before
    return np.asarray(inside * width + np.count_nonzero(passed, axis=0))


def between(below: Floats, above: Floats, share: float) -> Floats:
    """``below`` + ``share`` of the way to ``above``; both may be infinite."""
    if share == 0.0:
        return below
    with np.errstate(invalid="ignore"):
        return np.where(np.isinf(above), above, below + share * (above - below))


def bounds(samples: Floats) -> tuple[float, float]:
    """The 95 % interval of a statistic's draws (draws,): its percentiles, rounded outwards to one of the draws."""
    ascending = np.sort(samples)
    tail = (1.0 - CONFIDENCE) / 2.0 * (len(samples) - 1)
    low, high = int(np.floor(tail)), len(samples) - 1 - int(np.floor(tail))
    return float(ascending[low]), float(ascending[high])
