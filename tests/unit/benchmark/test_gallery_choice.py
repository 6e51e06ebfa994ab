"""Which frames the gallery shows, against tables whose worst frames are known by hand."""

from typing import Any

import numpy as np
import pandas as pd

from benchmark.gallery_choice import choose
from benchmark.gallery_item import conditions, verdict


def _row(method: str, case: str, frame: int, score: float | None, **more: Any) -> dict[str, Any]:
    answered = score is not None
    row = {
        "case": case, "run": f"{case}-seed0", "subject": "panel", "sensor": "nav", "modality": "mono", "method": method,
        "frame": frame, "time_s": float(frame), "outcome": "ok" if answered else "no_features", "answered": answered,
        "geodesic_deg": np.nan if score is None else np.degrees(score), "position_error_m": np.nan, "speed_rotation": score,
        "speed_position": np.nan, "score": score, "wrong": score is not None and score > 0.1, "range_m": 10.0,
        "phase_angle_deg": 40.0, "lit_fraction": 0.5, "saturated_fraction": 0.0,
    }  # fmt: skip
    return row | more


def _table() -> pd.DataFrame:
    rows = [_row("one", "sun", frame, score) for frame, score in enumerate((0.01, 0.9, 0.3, None, None))]
    rows += [_row("one", "dark", frame, score) for frame, score in enumerate((0.2, 0.05, 0.25))]
    rows += [_row("one", "flat", frame, 0.02 * frame) for frame in range(3)]
    rows += [_row("two", "sun", frame, score) for frame, score in enumerate((0.0, 0.0, 0.0, None, 0.0))]
    rows += [_row("far", "sun", 0, 0.4, modality="lidar", sensor="lidar", subject="lidar", position_error_m=0.2)]
    return pd.DataFrame(rows)


def test_each_method_shows_its_worst_answer_first_then_a_telling_failure_then_the_most_wrong_elsewhere() -> None:
    chosen = [(one.row["method"], one.kind, one.row["case"], one.row["frame"]) for one in choose(_table(), ["one", "two"])]
    mine = [one[1:] for one in chosen if one[0] == "one"]
    # of the frames without an answer the one that the other method did answer; the worst of "flat" is no wrong answer
    assert mine == [("worst", "sun", 1), ("unanswered", "sun", 4), ("wrong", "dark", 2), ("more", "flat", 2)]
    assert [one[1:] for one in chosen if one[0] == "two"] == [("worst", "sun", 0), ("unanswered", "sun", 3)]
    assert [one[0] for one in chosen[:3]] == ["one", "two", "far"]  # methods take turns


def test_the_number_of_frames_is_bounded_and_every_method_has_one_before_any_has_two() -> None:
    rows = [_row(f"m{method}", f"case{case}", 0, 0.1 + method + case) for method in range(8) for case in range(9)]
    chosen = choose(pd.DataFrame(rows), [f"m{method}" for method in range(8)], most=10)
    assert len(chosen) == 10
    assert [one.row["method"] for one in chosen] == [f"m{method % 8}" for method in range(10)]
    assert {one.row["case"] for one in chosen[:8]} == {"case8"}
    assert len(choose(pd.DataFrame(rows), [])) == 30


def test_an_empty_table_and_a_method_without_any_answer_give_no_worst_answer() -> None:
    assert choose(_table().iloc[:0], []) == ()
    lost = pd.DataFrame([_row("one", "sun", frame, None) for frame in range(3)])
    assert [one.kind for one in choose(lost, ["one"])] == ["unanswered"]


def test_the_words_say_how_far_off_an_answer_is_and_in_what_light() -> None:
    table = _table().set_index(["method", "case", "frame"], drop=False)
    assert verdict(table.loc[("one", "sun", 1)]) == "off by 51.6°: wrong"
    assert verdict(table.loc[("one", "flat", 2)]) == "off by 2.29°"
    assert verdict(table.loc[("far", "sun", 0)]) == "off by 22.9° and 200 mm: wrong"
    assert verdict(table.loc[("one", "sun", 3)]) == "no answer: no features found"
    assert conditions(table.loc[("one", "sun", 1)]) == "1 s · 10.0 m · phase angle 40° · 50 % lit · 0.0 % saturated"
