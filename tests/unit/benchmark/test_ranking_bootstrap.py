"""The block bootstrap: against NumPy on the frames that were drawn, and whether its intervals hold what they promise."""

import numpy as np
import pytest
from scipy.signal import lfilter

from benchmark.ranking_bootstrap import Track, bounds, counted, draw, quantiles, sums

_TRACKS = [Track("a", 40), Track("b", 27), Track("c", 2), Track("d", 1)]
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
    counts = _counts([Track("a", 20)], draws=20_000)
    np.testing.assert_allclose(counts.mean(axis=1), 1.0, atol=0.05)


def test_a_block_is_the_cube_root_of_its_track_and_goes_round() -> None:
    (blocks,) = draw([Track("a", 27)], 50, seed=1)
    assert (blocks.length, blocks.starts.shape) == (3, (50, 9))
    start = int(blocks.starts[0, 0])
    counts = blocks.counts(0, 1)[:, 0]
    assert (counts[[start, (start + 1) % 27, (start + 2) % 27]] > 0).all()
    assert [block.length for block in draw([Track("a", 28), Track("b", 1000)], 1, 0)] == [4, 10]


def test_draws_are_the_seeds_and_the_runs_alone() -> None:
    alone, among = _counts([Track("b", 27)]), _counts([Track("a", 9), Track("b", 27)])[9:]
    np.testing.assert_array_equal(alone, among)
    twice = _counts([Track("b", 27), Track("b", 27)])  # two features in the same pictures
    np.testing.assert_array_equal(twice[:27], twice[27:])
    assert (_counts([Track("b", 27)], seed=1) != alone).any()
    assert (_counts([Track("z", 27)]) != alone).any()


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


def _covered(tracks: list[Track], correlation: float) -> float:
    """How often the interval of the mean holds the true mean, 0, of 400 recordings whose errors are a first-order process."""
    draws, recordings, frames = 400, 400, tracks[0].frames
    noise = np.random.default_rng(5).normal(size=(len(tracks), frames + 100, recordings))
    errors = lfilter([1.0], [1.0, -correlation], noise, axis=1)[:, 100:].reshape(-1, recordings)
    drawn = np.concatenate([sums(counts, errors) for counts in counted(draw(tracks, draws, 0), draws)])
    low, high = np.array([bounds(column) for column in drawn.T]).T
    return float(np.mean((low <= 0.0) & (high >= 0.0)))


def test_the_interval_holds_the_truth_about_as_often_as_it_says() -> None:
    tracks = [Track(f"run {one}", 400) for one in range(4)]
    assert 0.92 <= _covered(tracks, 0.0) <= 0.98
    assert 0.91 <= _covered(tracks, 0.3) <= 0.98
    assert 0.88 <= _covered(tracks, 0.5) <= 0.97
