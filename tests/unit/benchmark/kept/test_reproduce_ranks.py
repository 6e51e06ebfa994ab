"""Two rankings beside each other: who was surely ahead stays ahead, and every figure stays inside its interval."""

import pytest

from benchmark.ranking_record import Difference, Division, Estimate, Ranking, Standing
from benchmark.reproduce import Judged
from benchmark.reproduce_figures import stated_of
from benchmark.reproduce_ranks import compared

FEW = Estimate(value=1.0, low=0.8, high=1.2)


def _standing(method: str, charge: float, **more: Estimate) -> Standing:
    fields = {"availability": FEW, "rotation_median_deg": FEW, "rotation_p95_deg": FEW, "wrong": FEW} | more
    estimate = Estimate(value=charge, low=charge - 0.1, high=charge + 0.1)
    return Standing(method=method, rank=1, is_tied=False, frames=9, answered=9, charge=estimate, **fields)


def _ranking(first: str, second: str, difference: float, sd: float = 0.02, charges: tuple[float, float] = (0.3, 0.35)) -> Ranking:
    pair = Difference(
        first=first, second=second, charge=Estimate(value=difference, low=difference - 2 * sd, high=difference + 2 * sd)
    )
    methods = (_standing(first, charges[0]), _standing(second, charges[1]))
    division = Division(modality="mono", cases=("c",), subjects=("s",), tracks=1, frames=9, methods=methods, differences=(pair,))
    return Ranking(divisions=(division,))


def _faults(reference: Ranking, found: Ranking) -> list[str]:
    judged = [Judged("ranking", *one) for one in compared(reference, found)]
    return [one.figure for one in judged if one.verdict == "outside"]


def test_a_ranking_reproduces_itself_and_one_listed_the_other_way_round() -> None:
    assert _faults(_ranking("a", "b", -0.05), _ranking("a", "b", -0.05)) == []
    assert _faults(_ranking("a", "b", -0.05), _ranking("b", "a", 0.05, charges=(0.35, 0.3))) == []


def test_a_pair_that_changed_places_is_named() -> None:
    found = _faults(_ranking("a", "b", -0.05), _ranking("b", "a", -0.05, charges=(0.3, 0.35)))
    assert found == ["charge", "a was ahead and is behind b"]


def test_a_sure_order_that_became_a_tie_is_named_and_a_tie_may_become_an_order() -> None:
    assert _faults(_ranking("a", "b", -0.05), _ranking("a", "b", -0.05, sd=0.03)) == ["a was ahead and is tied"]
    assert _faults(_ranking("a", "b", -0.05, sd=0.03), _ranking("a", "b", -0.05)) == []


def test_a_division_that_is_not_there_is_a_fault() -> None:
    assert _faults(_ranking("a", "b", -0.05), _ranking("a", "c", -0.05)) == ["the ranking has no such division"]


def test_a_charge_outside_its_interval_is_a_fault() -> None:
    assert _faults(_ranking("a", "b", -0.05), _ranking("a", "b", -0.05, charges=(0.45, 0.35))) == ["charge"]


@pytest.mark.parametrize(
    ("reference", "found", "verdict"),
    [
        (Estimate(value=2.0, low=1.0, high=None), None, "inside"),  # the interval reaches into the frames without an answer
        (Estimate(value=2.0, low=1.0, high=3.0), None, "outside"),
        (Estimate(value=None, low=1.0, high=None), None, "identical"),
        (Estimate(value=None, low=1.0, high=None), 1.5, "inside"),
        (Estimate(value=None, low=1.0, high=None), 0.5, "outside"),
        (Estimate(value=None, low=None, high=None), 5.0, "outside"),
    ],
)
def test_a_quantile_among_the_frames_without_an_answer_is_beyond_any_error(
    reference: Estimate, found: float | None, verdict: str
) -> None:
    there = stated_of(_standing("a", 0.3, rotation_p95_deg=reference))["rotation_p95_deg"]
    here = stated_of(_standing("a", 0.3, rotation_p95_deg=Estimate(value=found, low=0.1, high=None)))["rotation_p95_deg"]
    assert there.verdict(here.value) == verdict


def test_cpu_time_is_not_among_the_figures() -> None:
    assert "cpu_ms" not in stated_of(_standing("a", 0.3, cpu_ms=FEW))
