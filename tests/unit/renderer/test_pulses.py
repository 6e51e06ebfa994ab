"""Hits become pulses: what lies close together mixes, what lies apart is told apart."""

import numpy as np
import pytest

from renderer.beams import Echoes
from renderer.candidates import Candidates
from renderer.pulses import pulses


def echoes(range_m, cosine=1.0) -> Echoes:
    """Sub-rays (beams, n) that meet part 1 at these ranges; 0 = nothing."""
    ranges = np.atleast_2d(np.asarray(range_m, np.float32))
    cosines = np.where(ranges > 0, np.float32(cosine), np.float32(0))
    return Echoes(ranges, (ranges > 0).astype(np.uint32), cosines, cosines)


def found(range_m, electrons=None, resolution_m=0.5, spacing_rad=0.0, cosine=1.0):
    """Pulses of beams whose sub-rays send back ``electrons`` (one each if left out)."""
    met = echoes(range_m, cosine)
    strength = np.ones(met.range_m.shape) if electrons is None else np.atleast_2d(np.asarray(electrons, float))
    return pulses(met, strength, met.range_m > 0, resolution_m, spacing_rad)


def test_close_hits_mix_in_proportion_to_their_energy():
    one = found([10.0, 10.3, 10.0, 10.3], [1.0, 3.0, 1.0, 1.0])
    assert one.electrons.tolist() == [6.0]
    assert one.range_m == pytest.approx([10.0 + 0.3 * 4 / 6])
    assert one.stretch_m == pytest.approx([0.3 * np.sqrt(2 / 6 * 4 / 6)])
    assert one.fraction.tolist() == [1.0]


def test_hits_apart_are_pulses_from_near_to_far():
    several = found([[12.0, 10.0, 10.1, 0.0], [5.0, 0.0, 0.0, 0.0]])
    assert several.beam.tolist() == [0, 0, 1]
    assert several.place.tolist() == [0, 1, 0]
    assert several.range_m == pytest.approx([10.05, 12.0, 5.0])
    assert several.fraction.tolist() == [0.5, 0.25, 0.25]
    assert several.source.tolist() == [1, 0, 0]  # the sub-ray nearest to the axis


def test_hits_chain_over_gaps_that_are_each_within_the_resolution():
    assert len(found([10.0, 10.4, 10.8, 11.2]).beam) == 1
    assert len(found([10.0, 10.4, 11.0, 11.4]).beam) == 2


def test_a_tilted_surface_fills_the_gaps_between_its_hits():
    """At 20 m and 80 deg, rays 4 mrad apart meet a plane 0.45 m apart."""
    tilted = np.cos(np.radians(80.0))
    ranges = 20.0 + 0.45 * np.arange(4)
    assert len(found(ranges, resolution_m=0.1, spacing_rad=4e-3, cosine=tilted).beam) == 1
    assert len(found(ranges, resolution_m=0.1, spacing_rad=4e-3, cosine=1.0).beam) == 4
    assert len(found(ranges + np.array([0, 0, 1.0, 1.0]), resolution_m=0.1, spacing_rad=4e-3, cosine=tilted).beam) == 2


def test_pulses_without_energy_keep_their_range():
    dark = found([10.0, 10.2], [0.0, 0.0])
    assert dark.electrons.tolist() == [0.0]
    assert dark.range_m == pytest.approx([10.1])


def test_nothing_met_is_no_pulse():
    assert len(found([[0.0, 0.0], [0.0, 0.0]]).beam) == 0


def test_energy_is_kept_and_order_within_a_beam_does_not_matter():
    rng = np.random.default_rng(5)
    ranges = rng.choice([0.0, 10.0, 10.2, 11.5, 13.0], (200, 7))
    electrons = rng.uniform(1, 5, ranges.shape)
    straight = found(ranges, electrons)
    order = rng.permuted(np.tile(np.arange(7), (200, 1)), axis=1)
    shuffled = found(np.take_along_axis(ranges, order, 1), np.take_along_axis(electrons, order, 1))
    assert straight.electrons.sum() == pytest.approx(electrons[ranges > 0].sum())
    assert straight.electrons == pytest.approx(shuffled.electrons)
    assert straight.range_m == pytest.approx(shuffled.range_m)
    assert (np.diff(straight.range_m)[np.diff(straight.beam) == 0] > 0.5).all()


def test_the_first_of_each_beam_by_any_key():
    beam = np.array([4, 2, 4, 2, 9])
    offered = Candidates(beam, np.array([1.0, 5, 7, 3, 2]), np.array([10.0, 20, 5, 25, 1]), np.zeros(5), np.arange(5))
    assert offered.first_by(-offered.counted_e).tolist() == [1, 2, 4]
    assert offered.first_by(offered.range_m).tolist() == [1, 2, 4]
    assert offered.first_by(-offered.range_m).tolist() == [3, 0, 4]
    assert offered.only(np.array([0, 3])).first_by(np.zeros(2)).tolist() == [1, 0]
