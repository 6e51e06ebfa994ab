"""The block bootstrap: against NumPy on the frames that were drawn, and whether its intervals hold what they promise."""

import numpy as np
import pytest
from scipy.signal import lfilter

from benchmark.ranking_bootstrap import Track, block_length, bounds, counted, draw, quantiles, sums

_TRACKS = [Track("a", 40, 4), Track("b", 27, 3), Track("c", 2, 2), Track("d", 1, 1)]
_FRAMES = sum(track.frames for track in _TRACKS)


def _counts(tracks: list[Track], draws: int = 300, seed: int = 0) -> np.ndarray:
    return np.concatenate(list(counted(draw(tracks, draws, seed), draws)), axis=1)


def test_every_draw_takes_as_many_frames_of_each_track_as_it_has() -> None:
    counts = _counts(_TRACKS)
    assert counts.shape == (_FRAMES, 300)
    for first, last in ((0, 40), (40, 67), (67, 70)):  # the two short ones together
        assert set(counts[first:last].sum(axis=0)) == {last - first}
    assert len(np.unique(counts[67:], axis=1).T) > 1


def test_all_frames_are_drawn_equally_often() -> None:
    counts = _counts([Track("a", 20, 3)], draws=20_000)
    np.testing.assert_allclose(counts.mean(axis=1), 1.0, atol=0.05)


def test_a_block_is_successive_frames_and_goes_round() -> None:
    (blocks,) = draw([Track("a", 27, 3)], 50, seed=1)
    assert blocks.starts.shape == (50, 9)
    start = int(blocks.starts[0, 0])
    counts = blocks.counts(0, 1)[:, 0]
    assert (counts[[start, (start + 1) % 27, (start + 2) % 27]] > 0).all()


def test_a_block_is_the_cube_root_of_its_track_or_longer_where_errors_drift() -> None:
    noise = np.random.default_rng(3).normal(size=(1000, 1))
    assert [block_length(noise[:frames]) for frames in (1, 27, 28, 1000)] == [1, 3, 4, 10]
    assert block_length(np.ones((1000, 2))) == 10
    assert block_length(np.where(np.arange(1000) % 2, 1.0, -1.0)[:, None]) == 10
    drift = lfilter([1.0], [1.0, -0.9], noise, axis=0)
    correlation = np.sum(drift[1:] * drift[:-1]) / np.sum(drift**2)  # their mean is 0, but for 0.01
    assert block_length(drift) == pytest.approx((1.5 * (2 * correlation / (1 - correlation**2)) ** 2 * 1000) ** (1 / 3), abs=3)
    assert block_length(np.hstack([noise, drift])) == block_length(drift)
    assert block_length(np.cumsum(noise)[:, None]) == 333


def test_draws_are_the_seeds_and_the_runs_alone() -> None:
    alone, among = _counts([Track("b", 27, 3)]), _counts([Track("a", 9, 3), Track("b", 27, 3)])[9:]
    np.testing.assert_array_equal(alone, among)
    twice = _counts([Track("b", 27, 3), Track("b", 27, 3)])  # two features in the same pictures
    np.testing.assert_array_equal(twice[:27], twice[27:])
    assert (_counts([Track("b", 27, 3)], seed=1) != alone).any()
    assert (_counts([Track("z", 27, 3)]) != alone).any()


@pytest.mark.parametrize("lost", [0.0, 0.2, 0.52, 1.0])
def test_means_and_quantiles_are_those_of_the_frames_drawn(lost: float) -> None:
    rng = np.random.default_rng(2)
    values = rng.exponential(size=_FRAMES).round(2)
    values[rng.random(_FRAMES) < lost] = np.inf
    finite = np.where(np.isinf(values), 9.0, values)
    counts, levels = _counts(_TRACKS, draws=100), (0.0, 0.5, 0.95, 1.0)
    total, found = sums(counts, finite[:, None])[:, 0], quantiles(counts, values, levels)
    for one in range(100):
        drawn = np.repeat(values, counts[:, one])
        assert total[one] == pytest.approx(np.repeat(finite, counts[:, one]).sum())
        np.testing.assert_allclose(found[one], [_quantile(drawn, level) for level in levels])


def _quantile(values: np.ndarray, level: float) -> float:
    """NumPy's, where infinities do not make it NaN."""
    if np.isinf(np.sort(values)[int(np.ceil(level * (values.size - 1)))]):
        return np.inf
    return float(np.quantile(np.where(np.isinf(values), values[np.isfinite(values)].max(), values), level))


def test_bounds_leave_a_fortieth_on_each_side() -> None:
    assert bounds(np.arange(1001.0)[::-1]) == (25.0, 975.0)
    assert bounds(np.array([1.0, 2.0, np.inf])) == (1.0, np.inf)


def _covered(frames: int, correlation: float) -> float:
    """How often the interval of the mean holds the true mean, 0, of 400 recordings whose errors are a first-order process."""
    draws, recordings = 400, 400
    noise = np.random.default_rng(5).normal(size=(4, frames + 200, recordings))
    errors = lfilter([1.0], [1.0, -correlation], noise, axis=1)[:, 200:]
    tracks = [Track(f"run {one}", frames, block_length(track[:, :1])) for one, track in enumerate(errors)]
    flat = errors.reshape(-1, recordings)
    drawn = np.concatenate([sums(counts, flat) for counts in counted(draw(tracks, draws, 0), draws)])
    low, high = np.array([bounds(column) for column in drawn.T]).T
    return float(np.mean((low <= 0.0) & (high >= 0.0)))


@pytest.mark.parametrize(("correlation", "least"), [(0.0, 0.92), (0.3, 0.92), (0.6, 0.91), (0.9, 0.87)])
def test_the_interval_holds_the_truth_about_as_often_as_it_says(correlation: float, least: float) -> None:
    assert least <= _covered(400, correlation) <= 0.98


def test_the_interval_holds_the_truth_of_a_filters_errors_less_often() -> None:
    """Over 1000 frames that are correlated over 50 there is little to draw from; blocks of ten frames would give 0.5."""
    assert 0.80 <= _covered(1000, 0.98) <= 0.98
