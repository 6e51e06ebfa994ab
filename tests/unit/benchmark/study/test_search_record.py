"""What a search says it found: failures where frames fail, none where none does, and never more than it knows."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmark.errors import PredictionsError
from benchmark.ranking_rule import UNANSWERED_RAD
from benchmark.study import search_record
from benchmark.study.search_cost import SLOPE, bound_rad, cost, median_error_deg
from benchmark.study.search_page import chart, lines
from benchmark.study.search_record import TrialRecord, WorstBound, WorstRecord, chosen


def trial(value: float, right: int = 4, **more: object) -> TrialRecord:
    name = f"p{value:g}".replace(".", "")
    given = {"point": name, "label": f"light {value:g}", "value": value, "charge": value, "frames": 4, "answered": 4}
    return TrialRecord.model_validate({**given, "right": right, **more})


def record_of(*trials: TrialRecord, **more: object) -> WorstRecord:
    given = {"title": "T", "method": "M", "sampler": "tpe", "seed": 0, "identity": "0", "trials": trials, "worst": chosen(trials)}
    return WorstRecord.model_validate({**given, **more})


def frames_of(charge: list[float], modality: str = "mono", **columns: list[object]) -> pd.DataFrame:
    table = pd.DataFrame({"charge": charge, "modality": modality, "geodesic_deg": 1.0, "answered": True})
    return table.assign(bound_asked=True, bound_rotation_rad=0.1).assign(**columns)


def test_a_failure_is_fewer_than_nine_tenths_right() -> None:
    assert not trial(1.0, right=4).is_failure
    assert trial(1.0, right=3).is_failure
    assert not trial(1.0, right=0, is_dark=True).is_failure
    assert not trial(0.0, right=0, refused="no such scenario").is_failure
    assert not TrialRecord(value=1.0, frames=10, right=9).is_failure


def test_the_sentence_tells_what_was_found() -> None:
    found = record_of(trial(0.01), trial(2.2, right=0), trial(0.02))
    assert found.is_found
    assert found.sentence == "M fails in 1 of 3 trials; the worst is at light 2.2: 0 of 4 frames are right, the mean score is 2.2."
    none = record_of(trial(0.01), trial(0.013), trial(0.02))
    assert not none.is_found
    assert none.sentence.startswith("No failure of M was found in 3 trials; the largest score is at light 0.02: 4 of 4")
    assert "the mean score is 0.02" in none.sentence


def test_dark_and_impossible_lights_do_not_count() -> None:
    assert chosen((trial(2.2, is_dark=True), trial(1.0), trial(2.1, refused="why"))) == 1
    nothing = record_of(trial(2.2, is_dark=True), trial(0.0, refused="why"))
    assert nothing.worst is None
    assert "no light under which M could be asked" in nothing.sentence
    assert lines(nothing) == ()


def test_of_equal_trials_the_first_is_the_worst() -> None:
    assert chosen((trial(1.0), trial(2.0), trial(2.0))) == 1


def test_the_bound_is_told_as_known_undetermined_or_not_found() -> None:
    at = {"run": "p", "frame": 0, "sensor": "nav"}
    known = record_of(trial(1.0), bound=WorstBound(**at, rotation_rad=np.radians(0.5)))
    assert "σ = 0.5°" in known.bound_sentence
    assert "undetermined there" in record_of(trial(1.0), bound=WorstBound(**at)).bound_sentence
    assert "not found" in record_of(trial(1.0)).bound_sentence


def test_the_table_has_the_ten_worst_points_once_each() -> None:
    told = [trial(value / 100) for value in range(1, 13)] + [trial(0.12)]
    shown = lines(record_of(*told))
    assert [line.trial for line in shown] == list(range(12, 2, -1))
    assert [line.rank for line in shown] == list(range(1, 11))


def test_words_from_outside_stay_words_in_the_chart() -> None:
    svg = chart(record_of(trial(1.0, right=0, label="<script>alert(1)</script>"), method='"><b>'))
    assert "<script" not in svg
    assert "<b>" not in svg
    assert re.search(r'aria-label="[^"<>]*&lt;script&gt;', svg)


def test_a_record_is_read_as_it_was_written_and_faults_are_said(tmp_path: Path) -> None:
    found = record_of(trial(0.01), trial(2.2, right=0))
    with pytest.raises(PredictionsError, match=r"holds no worst\.json"):
        search_record.read(tmp_path)
    search_record.write(tmp_path, found)
    assert search_record.read(tmp_path) == found
    (tmp_path / "worst.json").write_text("{}", encoding="utf-8")
    with pytest.raises(PredictionsError, match=r"worst\.json"):
        search_record.read(tmp_path)


def test_the_cost_is_the_mean_charge_and_a_slope() -> None:
    frames = frames_of([0.1, 0.3], geodesic_deg=[18.0, 36.0])
    assert cost(frames) == pytest.approx(0.2 + SLOPE * 27 / 180, rel=1e-12)
    assert cost(frames.iloc[:0]) == 0.0


def test_the_slope_never_outweighs_a_failing_frame() -> None:
    """Even where all answered frames are off by as much as can be."""
    fails = cost(frames_of([UNANSWERED_RAD] + [0.0] * 99, geodesic_deg=[np.nan] + [0.0] * 99, answered=[False] + [True] * 99))
    assert cost(frames_of([0.0] * 100, geodesic_deg=[180.0] * 100)) < fails


def test_an_absurd_answer_costs_what_silence_costs() -> None:
    assert cost(frames_of([1e100, 0.0])) == pytest.approx(cost(frames_of([UNANSWERED_RAD, 0.0])))
    assert cost(frames_of([1e100], modality="stereo")) == pytest.approx(UNANSWERED_RAD + 1, abs=SLOPE)


def test_the_median_error_is_of_answered_frames() -> None:
    frames = frames_of([0.0] * 3, geodesic_deg=[1.0, 3.0, np.nan], answered=[True, True, False])
    assert median_error_deg(frames) == 2.0
    assert median_error_deg(frames[~frames["answered"]]) is None


def test_a_bound_that_most_frames_lack_is_undetermined() -> None:
    assert bound_rad(frames_of([0.0] * 3, bound_rotation_rad=[0.1, 0.3, np.nan])) == 0.3
    assert bound_rad(frames_of([0.0] * 3, bound_rotation_rad=[0.1, np.nan, np.nan])) == np.inf
    assert bound_rad(frames_of([0.0], bound_asked=[False])) == np.inf
