"""The record of a study's scores: written, read back, refused where damaged, and as the console prints it."""

import io
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from benchmark.console import Console
from benchmark.errors import PredictionsError
from benchmark.ranking_record import Estimate
from benchmark.ranking_rule import UNANSWERED_RAD
from benchmark.study.outcomes import Outcomes
from benchmark.study.score_cells import broken, change, tables
from benchmark.study.score_record import BreakPoint, Crossing, Index, Overall, Sensitivity, StudyScores
from benchmark.study.scores import FILE, read, study_scores, write


@pytest.fixture
def found(ladder: Callable, hardness: np.ndarray) -> Outcomes:
    def charge(method: str, point: pd.Series, seed: int, frame: int) -> float:
        cost = 0.05 * (1 + (method == "b")) * (0.5 + hardness[seed, frame]) * point["gain"]
        return float(cost) if cost < 0.4 else UNANSWERED_RAD

    study = ladder(references={"mono": "b"})
    return study.outcomes(charge, ("a", "b"), seeds=(0.0, 1.0), bound=lambda p, f: np.nan if f == 3 else 0.001)


def test_what_is_written_is_read_back(found: Outcomes, tmp_path: Path) -> None:
    scores = study_scores(found)
    assert all((scores.overall, scores.levels, scores.errors, scores.means, scores.break_points))
    write(tmp_path, scores)
    assert read(tmp_path) == scores
    first = (tmp_path / FILE).read_bytes()
    write(tmp_path, study_scores(replace(found, frames=found.frames.sample(frac=1.0, random_state=0))))
    assert (tmp_path / FILE).read_bytes() == first  # the same outcomes, the same bits


def test_what_is_not_there_or_damaged_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(PredictionsError, match=r"holds no scores\.json; run hardlight study again"):
        read(tmp_path)
    (tmp_path / FILE).write_text('{"overall": [{"modality": "sonar"}]}')
    with pytest.raises(PredictionsError, match=r"scores\.json is damaged: overall\.0\.modality"):
        read(tmp_path)


def test_modalities_are_scored_apart(ladder: Callable, hardness: np.ndarray) -> None:
    study = ladder(references={"mono": "m", "lidar": "l"})
    parts = [study.outcomes(lambda m, p, s, f: hardness[s, f], (m,), modality=kind) for m, kind in (("l", "lidar"), ("m", "mono"))]
    both = study_scores(replace(parts[0], frames=pd.concat([one.frames for one in parts])))
    assert [(one.modality, one.method) for one in both.overall] == [("mono", "m"), ("lidar", "l")]
    assert both.means[1] == study_scores(parts[0]).means[0]
    assert [one for one in both.levels if one.modality == "lidar"] == list(study_scores(parts[0]).levels)


def test_nothing_answered_is_no_scores(found: Outcomes) -> None:
    assert study_scores(replace(found, frames=found.frames.head(0))) == StudyScores()


def _printed(scores: StudyScores) -> str:
    with redirect_stdout(io.StringIO()) as printed:
        for title, rows in tables(scores):
            Console().table(title, rows)
    return printed.getvalue()


def test_the_console_holds_the_tables(found: Outcomes) -> None:
    scores = study_scores(found)
    said = _printed(scores)
    assert max(map(len, said.splitlines())) <= 140
    titles = [title for title, _ in tables(scores)]
    assert titles == ["One camera: all points", "One camera: factors", "One camera: gain", "One camera: idle"]
    assert [row["level"] for row in dict(tables(scores))["One camera: gain"]][::2] == ["1× (baseline)", "2×", "4×", "8×"]
    assert "never" in said


def test_of_a_sphere_the_hardest_direction_is_printed(sphere: Any, hardness: np.ndarray) -> None:
    scores = study_scores(sphere.outcomes(lambda m, p, s, f: hardness[s, f] * (2 + p["sun_z"]), ("a", "b")))
    rows = dict(tables(scores))["One camera: sun, hardest level"]
    hardest = sphere.points["sun_z"].idxmax()
    phase_deg = np.degrees(np.arccos(-sphere.points["sun_z"][hardest]))
    assert [row["method"] for row in rows] == ["a", "b"]
    assert rows[0]["level"].startswith(f"phase {phase_deg:.0f}°")


def test_indices_are_printed_or_why_there_are_none() -> None:
    share = Estimate(value=0.5, low=0.4, high=0.6)
    scores = StudyScores(
        overall=(),
        sensitivity=(
            Sensitivity(
                modality="mono", method="a", output="charge", samples=8, indices=(Index(factor="gain", first=share, total=share),)
            ),
            Sensitivity(modality="mono", method="a", output="availability", samples=8, lacking="it does not vary"),
        ),
    )
    whole = scores.model_copy(update={"overall": _overall()})
    rows = dict(tables(whole))["One camera: share of the variance that each factor has alone, and in all"]
    said = "0.500\n0.400–0.600"
    assert rows[0] == {"method": "a", "of the": "score", "factor": "gain", "alone": said, "in all": said}
    assert (rows[1]["of the"], rows[1]["factor"], rows[1]["alone"]) == ("share right", "it does not vary", "—")
    assert not tables(scores)


def _overall() -> tuple[Any, ...]:
    one = Estimate(value=0.5)
    return (Overall(modality="mono", method="a", frames=8, availability=one, charge=one),)


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (None, ""), (Estimate(value=None), ""), (Estimate(value=0.0, low=0.0, high=0.0), "0"), (Estimate(value=1.5), "+1.50"),
        (Estimate(value=-0.5, low=-1.0, high=0.25), "−0.500 (−1.00 to +0.250)"),
    ],
)  # fmt: skip
def test_a_difference_has_its_sign(estimate: Estimate | None, text: str) -> None:
    assert change(estimate) == text


@pytest.mark.parametrize(
    ("said", "text"),
    [
        ([Crossing(kind="never")], "never"),
        ([Crossing(kind="never")] * 3, "never"),
        ([Crossing(kind="at", value=3.0), Crossing(kind="already"), Crossing(kind="never")], "3 (already to never)"),
        ([Crossing(kind="at", value=3.25), Crossing(kind="at", value=3.5), Crossing(kind="at", value=2.0)], "3.25 (3.5 to 2)"),
    ],
)
def test_a_break_point_is_a_word_or_a_level(said: list[Crossing], text: str) -> None:
    ends = dict(zip(("found", "nearest", "farthest"), said))
    assert broken(BreakPoint(modality="mono", method="a", factor="f", going="up", start=0.0, start_is="baseline", **ends)) == text
