"""Sobol' indices: of methods whose dependence on the factors is known exactly."""

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd
import pytest

from benchmark.ranking_rule import UNANSWERED_RAD
from benchmark.study.outcomes import Outcomes
from benchmark.study.problem import problem, samples
from benchmark.study.record import FactorRecord, StudyRecord
from benchmark.study.score_record import Sensitivity
from benchmark.study.scores import study_scores
from benchmark.study.sensitivity import indices

_NAMES = ("a", "b", "c")
_DIRECTED = (
    FactorRecord(name="gain", title="gain"),
    FactorRecord(name="sun", title="the Sun", kind="direction", dimensions=2),
    FactorRecord(name="idle", title="idle"),
)


def _numbers(names: Sequence[str] = _NAMES) -> tuple[FactorRecord, ...]:
    return tuple(FactorRecord(name=name, title=name) for name in names)


def _ishigami(unit: np.ndarray) -> np.ndarray:
    """sin x + 7 sin² y + 0.1 z⁴ sin x over (−π, π)³ (Ishigami & Homma 1990)."""
    x, y, z = (np.pi * (2 * unit - 1)).T
    return np.sin(x) + 7 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)


def _exact_ishigami() -> tuple[np.ndarray, np.ndarray]:
    """First-order and total indices, by integration: of z alone nothing, with x a share."""
    a, b = 7.0, 0.1
    of_x, of_y = 0.5 * (1 + b * np.pi**4 / 5) ** 2, a**2 / 8
    of_xz = b**2 * np.pi**8 * (1 / 18 - 1 / 50)
    whole = of_x + of_y + of_xz
    return np.array([of_x, of_y, 0.0]) / whole, np.array([of_x + of_xz, of_y, of_xz]) / whole


def _within(found: Sequence, first: Sequence[float], total: Sequence[float]) -> None:
    for one, alone, whole in zip(found, first, total, strict=True):
        assert one.first.low - 1e-9 <= alone <= one.first.high + 1e-9, one
        assert one.total.low - 1e-9 <= whole <= one.total.high + 1e-9, one
        assert one.first.high - one.first.low < 0.2  # and the interval says something
        assert one.total.high - one.total.low < 0.2


def _study(
    factors: tuple[FactorRecord, ...], base: int, charge: Callable[[np.ndarray], np.ndarray], frames: int = 3, seed: int = 0
) -> Outcomes:
    """A Sobol study in which a frame costs what ``charge`` makes of the places (n, dimensions); equal places are one point."""
    unit = samples(factors, base, seed)
    names = [f"p{hash(tuple(row)) & 0xFFFFFFFFFF:010x}" for row in unit]
    points = pd.DataFrame({"point": names, "moved": "", "label": ""})
    record = StudyRecord(title="Sobol", design="sobol", seed=seed, samples=base, factors=factors)
    cost = charge(unit)
    table = pd.DataFrame({"point": names, "charge": cost}).drop_duplicates("point")
    table = table.merge(pd.DataFrame({"frame": range(frames)}), "cross")
    right = table["charge"] < UNANSWERED_RAD
    frames_table = table.assign(
        case=table["point"], seed=np.nan, subject="panel", sensor="nav", modality="mono", method="ours", right=right,
        geodesic_deg=np.degrees(table["charge"]), bound_rotation_rad=np.nan, bound_asked=False, bound_determined=False,
    )  # fmt: skip
    return Outcomes(record, points, frames_table)


def _of(found: Outcomes, output: str) -> Sensitivity:
    (one,) = (one for one in study_scores(found).sensitivity if one.output == output)
    return one


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_ishigamis_indices_are_within_their_intervals(seed: int) -> None:
    factors = _numbers()
    found = indices(factors, _ishigami(samples(factors, 1024, seed)), seed)
    assert found is not None
    assert [one.factor for one in found] == list(_NAMES)
    _within(found, *_exact_ishigami())


def test_an_interval_around_another_functions_indices_does_not_hold_them() -> None:
    """The control: Ishigami's are not those of a sum."""
    found = indices(_numbers(), samples(_numbers(), 1024, 0) @ [1.0, 2.0, 3.0], 0)
    assert found is not None
    with pytest.raises(AssertionError):
        _within(found, *_exact_ishigami())


def test_a_methods_dependence_is_recovered_from_its_frames() -> None:
    """charge = 0.2 + 0.3 u + 0.6 (v + w) / 2, whose variances are 0.09 and 2 · 0.09 twelfths; of the Sun's two axes one index."""
    found = _of(_study(_DIRECTED, 512, lambda unit: 0.2 + unit @ [0.3, 0.3, 0.3, 0.0]), "charge")
    assert found.indices is not None
    assert (found.samples, found.lacking) == (512, "")
    _within(found.indices, [1 / 3, 2 / 3, 0.0], [1 / 3, 2 / 3, 0.0])


def test_of_what_cannot_matter_both_indices_are_exactly_nothing() -> None:
    study = _study(_DIRECTED, 64, lambda unit: 0.1 + 0.7 * unit[:, 0] * unit[:, 1])
    found = _of(study, "charge").indices
    assert found is not None
    for one in (found[2].first, found[2].total):
        assert (one.value, one.low, one.high) == (0.0, 0.0, 0.0)
    assert found[0].total.value > found[0].first.value > 0


def test_availability_has_indices_of_its_own() -> None:
    """It fails where the first is above a half, which costs the same everywhere: all variance is the first's."""
    study = _study(_numbers(), 1024, lambda unit: np.where(unit[:, 0] > 0.5, UNANSWERED_RAD, 0.01 * unit[:, 1]))
    found = _of(study, "availability")
    assert found.indices is not None
    _within(found.indices, [1.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    assert found.indices[1].total.value == 0.0


def test_a_constant_output_has_no_indices() -> None:
    study = _study(_numbers(), 16, lambda unit: np.full(len(unit), 0.1))
    for one in study_scores(study).sensitivity:
        assert one.indices is None
        assert one.lacking == "it does not vary"
    almost = _study(_numbers(), 16, lambda unit: 0.1 + 0.1 * unit[:, 0])
    assert _of(almost, "availability").indices is None
    assert _of(almost, "charge").indices is not None


def test_what_varies_in_a_mixed_row_alone_is_no_variance() -> None:
    """One point of a mixed row is odd, and neither sample knows of it: SALib would divide by nothing."""
    output = np.zeros(5 * 8)
    output[7] = 1.0
    assert indices(_numbers(), output, 0) is None
    odd = _of(_study(_numbers(), 16, lambda unit: 0.1 + 0.1 * (np.arange(len(unit)) == 7)), "charge")
    assert odd.lacking == "it varies too rarely: the 32 independent points are all alike"


def test_a_sample_that_misses_a_point_is_left_out_whole() -> None:
    study = _study(_numbers(), 1024, lambda unit: unit @ [0.1, 0.2, 0.3])
    lost = study.points["point"].iloc[[3, 42]]
    few = Outcomes(study.record, study.points, study.frames[~study.frames["point"].isin(lost)])
    found = _of(few, "charge")
    assert found.samples == 1022
    assert found.indices is not None
    _within(found.indices, np.array([1, 4, 9]) / 14, np.array([1, 4, 9]) / 14)
    cut = _of(Outcomes(study.record, study.points.drop(index=3), few.frames), "charge")
    assert cut.indices is None
    assert cut.lacking == "of 5119 points, 5 a sample, some are missing"


def test_the_same_study_gives_the_same_intervals() -> None:
    one, other = (_of(_study(_numbers(), 32, _ishigami), "charge") for _ in range(2))
    assert one == other


def test_a_design_is_saltellis_with_a_group_for_each_factor() -> None:
    """A row of each block differs from its first in one factor alone, in all its axes; the last in all."""
    said = problem(_DIRECTED)
    assert (said["num_vars"], said["groups"]) == (4, ["gain", "sun", "sun", "idle"])
    blocks = samples(_DIRECTED, 8, 3).reshape(8, 5, 4)
    moved = blocks != blocks[:, :1]
    expected = np.array([[0, 0, 0, 0], [1, 0, 0, 0], [0, 1, 1, 0], [0, 0, 0, 1], [1, 1, 1, 1]], dtype=bool)
    assert (moved == expected).all()
    np.testing.assert_array_equal(blocks[:, 2, 1:3], blocks[:, 4, 1:3])
    assert ((blocks >= 0) & (blocks < 1)).all()
    np.testing.assert_array_equal(samples(_DIRECTED, 8, 3), samples(_DIRECTED, 8, 3))
    assert (samples(_DIRECTED, 8, 3) != samples(_DIRECTED, 8, 4)).any()
    assert samples(_DIRECTED, 6, 0).shape == (30, 4)  # no power of two, and no warning
