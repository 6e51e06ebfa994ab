"""CE and mCE: by hand, against the frozen reference and the one of this run."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

from benchmark.study.score_record import FactorError, MeanError
from benchmark.study.scores import study_scores

_COST = {"ref": {1: 0.1, 2: 0.2, 4: 0.4, 8: 0.8}, "ours": {1: 0.1, 2: 0.1, 4: 0.2, 8: 0.8}}
_IDLE = {"ref": 0.1, "ours": 0.1}


def _found(ladder: Callable, spread: np.ndarray | None = None, **more: Any) -> tuple[dict, dict]:
    """The errors by (method, factor) and the means by method."""

    def charge(method: str, point: pd.Series, seed: int, frame: int) -> float:
        return float(_COST[method][int(point["gain"])] * (1.0 if spread is None else spread[seed, frame]))

    scores = study_scores(ladder(**more).outcomes(charge, ("ours", "ref"), seeds=(0.0, 1.0)))
    return {(one.method, one.factor): one for one in scores.errors}, {one.method: one for one in scores.means}


def _value(one: FactorError | MeanError, name: str) -> float:
    value = getattr(one, name).value
    assert isinstance(value, float)
    return value


def test_errors_are_those_of_the_levels_by_the_references_of_this_run(ladder: Callable) -> None:
    errors, means = _found(ladder, references={"mono": "ref"})
    gain = errors["ours", "gain"]
    assert _value(gain, "charge") == pytest.approx(1.1 / 3)
    assert _value(gain, "ce") == pytest.approx(1.1 / 1.4)
    assert _value(gain, "relative_ce") == pytest.approx((1.1 - 0.3) / (1.4 - 0.3))
    assert gain.reference == pytest.approx(1.4 / 3)
    assert gain.reference_is == "this run"
    assert _value(means["ours"], "mce") == pytest.approx((1.1 / 1.4 + 1.0) / 2)
    assert means["ours"].factors == ("gain", "idle")
    assert means["ours"].reference_method == "ref"


def test_the_reference_measures_itself_by_one_without_doubt(ladder: Callable, hardness: np.ndarray) -> None:
    errors, means = _found(ladder, 0.2 + hardness, references={"mono": "ref"})
    for one in (errors["ref", "gain"].ce, errors["ref", "gain"].relative_ce, means["ref"].mce, means["ref"].relative_mce):
        assert (one.value, one.low, one.high) == (1.0, 1.0, 1.0)


def test_what_adds_nothing_to_the_reference_has_no_relative_error(ladder: Callable) -> None:
    errors, means = _found(ladder, references={"mono": "ref"})
    assert errors["ours", "idle"].relative_ce is None
    assert _value(errors["ours", "idle"], "ce") == 1.0
    assert means["ours"].relative_factors == ("gain",)
    assert _value(means["ours"], "relative_mce") == pytest.approx(0.8 / 1.1)


def test_a_frozen_reference_stays_what_it_was(ladder: Callable, hardness: np.ndarray) -> None:
    spread = 0.2 + hardness
    errors, means = _found(ladder, spread, references={"mono": "ref"}, frozen={"mono": {"gain": 0.5}})
    gain, idle = errors["ours", "gain"], errors["ours", "idle"]
    assert (gain.reference, gain.reference_is) == (0.5, "frozen")
    assert _value(gain, "ce") == pytest.approx(_value(gain, "charge") / 0.5)
    assert gain.ce.low == pytest.approx(gain.charge.low / 0.5)
    assert idle.reference_is == "this run"
    assert _value(means["ours"], "mce") == pytest.approx((_value(gain, "ce") + _value(idle, "ce")) / 2)
    alone = study_scores(ladder(frozen={"mono": {"gain": 0.5}}).outcomes(lambda *_: 0.25)).errors
    assert [_value(alone[0], "ce"), alone[1].ce] == [0.5, None]


def test_without_a_reference_there_are_charges_alone(ladder: Callable) -> None:
    for references in ({}, {"mono": "absent"}, {"lidar": "ref"}):
        errors, means = _found(ladder, references=references)
        one, mean = errors["ours", "gain"], means["ours"]
        assert _value(one, "charge") == pytest.approx(1.1 / 3)
        assert one.ce is one.relative_ce is one.reference is one.reference_is is mean.mce is mean.relative_mce is None


def test_a_ratio_is_surer_than_what_it_is_made_of(ladder: Callable, hardness: np.ndarray) -> None:
    """Both methods meet the same hard frames, which cancel."""
    errors, _ = _found(ladder, 0.2 + hardness, references={"mono": "ref"})
    one = errors["ours", "gain"]
    assert one.ce.high - one.ce.low < 1e-9
    assert one.charge.high - one.charge.low > 0.05


def test_a_sphere_has_no_baseline_and_so_no_relative_error(sphere: Any, hardness: np.ndarray) -> None:
    record = sphere.record.model_copy(update={"references": {"mono": "ref"}})
    found = type(sphere)(record, sphere.points).outcomes(
        lambda m, p, s, f: hardness[s, f] * (2 if m == "ref" else 1 + (p["sun_z"] > 0)), ("ours", "ref")
    )
    (ours, _) = study_scores(found).errors
    assert _value(ours, "ce") == pytest.approx((1 + (sphere.points["sun_z"] > 0).mean()) / 2)
    assert ours.relative_ce is None


@pytest.mark.parametrize("cost", [0.0, 1e-30])
def test_a_reference_that_costs_nothing_measures_nothing(ladder: Callable, cost: float) -> None:
    found = ladder(references={"mono": "ref"}).outcomes(lambda m, p, s, f: cost if m == "ref" else 0.1, ("ours", "ref"))
    one = study_scores(found).errors[0]
    assert one.relative_ce is None
    assert (one.ce is None) == (cost == 0.0)
