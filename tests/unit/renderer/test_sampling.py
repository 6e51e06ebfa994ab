"""Nets: evenness, independence of each other, freedom from bias."""

import numpy as np
import pytest

from renderer.sampling import MOST_SAMPLES, net
from renderer.variant import activate
from scenes.arrays import Floats


@pytest.fixture(scope="module", autouse=True)
def variant() -> None:
    """Whatever renders here; these tests need a wavefront."""
    if activate().is_scalar:
        pytest.skip("no LLVM that works")


def _net(pixels: int, samples: int, salt: int = 0) -> Floats:
    """Points (pixels, samples, 2)."""
    import drjit as dr
    import mitsuba as mi

    starts = np.random.default_rng(salt).integers(2**32, size=(3, pixels, 1), dtype=np.uint64).repeat(samples, axis=2)
    start = mi.Vector3u(*(one.ravel().astype(np.uint32) for one in starts))
    index = mi.UInt32(np.tile(np.arange(samples, dtype=np.uint32), pixels))
    return np.array(net(mi, dr, start, index)).T.reshape(pixels, samples, 2).astype(np.float64)


@pytest.mark.parametrize("log2_samples", [2, 4, 6, 8])
def test_every_elementary_interval_holds_one_point(log2_samples: int):
    count = 2**log2_samples
    for points in _net(20, count):
        assert points.min() >= 0
        assert points.max() < 1
        for split in range(log2_samples + 1):
            cells = np.floor(points * [2**split, count // 2**split]).astype(int)
            assert len(np.unique(cells, axis=0)) == count


def test_blocks_of_a_net_are_nets():
    points = _net(1, MOST_SAMPLES)[0]
    for block in points.reshape(-1, 16, 2):
        assert len(np.unique(np.floor(block * 4).astype(int), axis=0)) == 16


def test_means_are_free_of_bias_and_converge_faster_than_at_random():
    def error(samples: int) -> float:
        points = _net(4000, samples)
        means = np.mean(np.exp(-3 * points[..., 0]) * (points[..., 1] > 0.37), axis=1)
        true = (1 - np.exp(-3)) / 3 * 0.63
        assert means.mean() == pytest.approx(true, abs=4 * means.std() / np.sqrt(4000))
        return float(means.std())

    slope = np.polyfit(np.log([4, 16, 64]), np.log([error(count) for count in (4, 16, 64)]), 1)[0]
    assert slope < -0.7  # at random: -0.5


def test_two_nets_of_a_pixel_do_not_pair_up():
    """The mean of a product over four dimensions: nets in the same order would tie the first to the third."""
    first, second = _net(4000, 16, salt=1), _net(4000, 16, salt=2)
    correlation = np.mean((first[..., 0] - 0.5) * (second[..., 0] - 0.5), axis=1) * 12
    assert abs(correlation.mean()) < 0.02
    assert correlation.std() < 0.35  # 1/√16 = 0.25 at random; 1 where they keep step
