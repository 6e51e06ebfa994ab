"""Which figures of a summary are judged, and by which bounds."""

from typing import Any

import pytest

from benchmark.figure import Figure
from benchmark.filter_summary import Consistency, FilterSummary, StateFigure
from benchmark.reproduce_figures import Stated, stated
from benchmark.ring_summary import RingSummary
from benchmark.summary import Summary


def _summary(**more: Any) -> Summary:
    fields = {
        "method": "m", "title": "m", "sensor": "s", "dataset_identity": "0", "knowledge": None, "symmetry": "none", "frames": 100,
        "answered": 90, "outcomes": {"ok": 90}, "availability": 0.9, "wrong": 0, "wrong_but_confident": 0.0, "label_switches": 0,
    }  # fmt: skip
    return Summary.model_validate(fields | more)


def _filter(is_converged: bool) -> FilterSummary:
    return FilterSummary(
        gauge="target",
        steady_from_s=80.0,
        steady_frames=20,
        steady_answered=20,
        is_converged=is_converged,
        states={
            "attitude": StateFigure(three_sigma=(0.1, 0.2), worst=0.2, level=1.5, settled_s=4.0),
            "p": StateFigure(three_sigma=(None,), worst=None, level=0.05, settled_s=None),
        },
        inertia_error=0.02,
        nees=Consistency(frames=20, mean=18.0, median=17.0, expected=20.0, low=9.6, high=34.2),
        icp_attitude_median_deg=0.15,
        stage_cpu_s={"icp": 0.01},
    )


def test_counts_have_wilsons_interval() -> None:
    """90 of 100: 0.8256 … 0.9448; none of 100: 0 … 0.0370 (Brown, Cai & DasGupta 2001, eq. 4)."""
    found = stated(_summary())
    assert (found["availability"].low, found["availability"].high) == pytest.approx((0.8256, 0.9448), abs=1e-4)
    assert (found["wrong_but_confident"].low, found["wrong_but_confident"].high) == pytest.approx((0.0, 0.0370), abs=1e-4)
    assert found["frames"] == Stated(100.0, 100.0, 100.0)


def test_every_figure_of_the_tree_is_found_with_its_own_interval() -> None:
    three = (Figure(value=1.0, low=0.5, high=1.5), Figure(value=2.0, low=1.5, high=2.5), Figure(value=3.0))
    ring = RingSummary(bias_mm=three, radius_sd_mm=Figure(value=0.1, low=0.0, high=0.2), ring_judged=90, ring_right_fraction=0.8)
    found = stated(_summary(ring=ring, geodesic_median_deg=Figure(value=4.0, low=3.0, high=6.0)))
    assert found["ring.bias_mm.1"] == Stated(2.0, 1.5, 2.5)
    assert found["ring.radius_sd_mm"] == Stated(0.1, 0.0, 0.2)
    assert found["geodesic_median_deg"] == Stated(4.0, 3.0, 6.0)
    assert found["ring.ring_right_fraction"].value == 0.8
    without = found["ring.bias_mm.2"]
    assert (without.low, without.high) == pytest.approx((2.85, 3.15))


def test_of_a_filter_that_converged_states_and_consistency_are_judged_to_five_percent() -> None:
    found = {name: one for name, one in stated(_summary(filter=_filter(True))).items() if name.startswith("filter.")}
    assert found.keys() == {
        "filter.is_converged", "filter.states.attitude.worst", "filter.inertia_error", "filter.nees.mean",
        "filter.icp_attitude_median_deg",
    }  # fmt: skip
    assert (found["filter.nees.mean"].low, found["filter.nees.mean"].high) == pytest.approx((17.1, 18.9))


def test_of_a_filter_that_did_not_converge_that_alone_is_judged() -> None:
    found = stated(_summary(filter=_filter(False)))
    assert [name for name in found if name.startswith("filter.")] == ["filter.is_converged"]
    assert found["filter.is_converged"].verdict(1.0) == "outside"


@pytest.mark.parametrize(
    ("found", "verdict"),
    [(2.0, "identical"), (2.000001, "identical"), (2.1, "inside"), (2.5, "inside"), (2.51, "outside"), (None, "outside")],
)
def test_a_figure_is_identical_inside_or_outside(found: float | None, verdict: str) -> None:
    assert Stated(2.0, 1.5, 2.5).verdict(found) == verdict


def test_an_interval_that_leaves_out_its_own_value_still_takes_the_same_value() -> None:
    assert Stated(2.0, 2.1, 2.5).verdict(2.0) == "identical"
    assert Stated(-2.0, -2.1, -1.9).verdict(-2.05) == "inside"
    assert Stated(0.0, 0.0, 0.0).verdict(1e-12) == "identical"
