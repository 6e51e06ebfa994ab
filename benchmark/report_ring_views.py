"""What the page shows of a case's ring: the rows of its table, what the paper printed beside them, the plot, the pictures."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmark import predictions
from benchmark.judge import SCORES
from benchmark.leaderboard import Row, minus
from benchmark.metrics import WRONG_DEG
from benchmark.predictions import Predictions
from benchmark.report_ring_pictures import Strip, strip
from benchmark.report_ring_plots import RingTrack, ring_plot
from benchmark.report_ring_printed import PrintedView, printed_view
from benchmark.results import Results
from benchmark.ring_scores import WRONG_OF_RANGE
from benchmark.ring_subject import subject_of
from benchmark.ring_summary import RingSummary
from scenes.dataset import Dataset

_RIGHT = {1.0: "the ring", 0.0: "another ring"}


@dataclass(frozen=True, slots=True, eq=False)
class RingEntryView:
    """One row of a ring's table and the frames behind it."""

    row: Row
    series: int
    answers: Predictions
    scores: pd.DataFrame
    strips: tuple[Strip, ...]

    @property
    def ring(self) -> RingSummary:
        """The ring's block of the row's summary."""
        return self.row.summary.ring or RingSummary()


@dataclass(frozen=True, slots=True, eq=False)
class RingView:
    """Everything about one ring of one case."""

    name: str
    plot: str
    entries: tuple[RingEntryView, ...]
    printed: tuple[PrintedView, ...]


def ring_view(folder: Path, index: Results, dataset: Dataset, rows: Sequence[Row], titles: Sequence[str]) -> RingView:
    """The view of the ``rows`` of one ring; a method's place in ``titles`` is its colour."""
    case, feature = rows[0].entry.case, rows[0].entry.feature or ""
    entries = tuple(_entry(folder, dataset, row, titles.index(row.entry.title)) for row in rows)
    tracks = [_track(entry) for entry in entries]
    plot = ring_plot(tracks, f"{case}-{feature}", f"{case}, {feature}: error against frame for {len(entries)} methods")
    summaries = [row.summary for row in rows]
    printed = tuple(printed_view(one, summaries) for one in index.published_rings if one.case == case)
    return RingView(feature, plot, entries, printed)


def reason(score: pd.Series, answers: Predictions) -> str:
    """Why a frame has no answer, in the method's own words, behind a dash; empty where it gave none."""
    if answers.extras is None or "reason" not in answers.extras:
        return ""
    here = (answers.extras["frame"] == score["frame"]) & (answers.extras["sensor"] == score["sensor"])
    text = "".join(answers.extras.loc[here, "reason"].head(1))
    return f" — {text}" if text else ""


def _entry(folder: Path, dataset: Dataset, row: Row, series: int) -> RingEntryView:
    answers = predictions.read(folder / row.entry.answers)
    scores = pd.read_parquet(folder / row.entry.scores / SCORES)
    scores = scores[scores["sensor"] == row.summary.sensor]
    return RingEntryView(row, series, answers, scores, tuple(_strips(dataset, answers, scores)))


def _track(entry: RingEntryView) -> RingTrack:
    scores = entry.scores
    return RingTrack(
        title=entry.row.entry.title,
        series=entry.series,
        frames=scores["frame"].to_numpy(dtype=np.float64),
        z_error_mm=1e3 * scores["ring_z_error_m"].to_numpy(dtype=np.float64),
        normal_error_deg=scores["normal_error_deg"].to_numpy(dtype=np.float64),
        answered=(scores["outcome"] == "ok").to_numpy(),
    )


def _strips(dataset: Dataset, answers: Predictions, scores: pd.DataFrame) -> Iterator[Strip]:
    """The first frame, the middle one and the worst answer, in the order of time, each once."""
    subject = subject_of(answers.record.knowledge, dataset)
    if subject is None:
        return
    frames = scores["frame"].to_list()
    named = {frames[0]: "first", frames[len(frames) // 2]: "middle"}
    worst = _worst(scores)
    if worst is not None:
        named[worst] = f"{named[worst]} and worst" if worst in named else "worst"
    sensor = str(scores["sensor"].iloc[0])
    for frame, name in sorted(named.items()):
        score = scores[scores["frame"] == frame].iloc[0]
        given = _of(answers.table, frame, sensor)
        extras = None if answers.extras is None else _of(answers.extras, frame, sensor)
        numbers = {} if extras is None else {str(key): value for key, value in extras.items() if isinstance(value, float)}
        yield strip(dataset, subject, score if given is None else given, numbers, _caption(score, answers, name))


def _of(table: pd.DataFrame, frame: int, sensor: str) -> pd.Series | None:
    """The row of one frame and sensor."""
    rows = table[(table["frame"] == frame) & (table["sensor"] == sensor)]
    return None if rows.empty else rows.iloc[0]


def _worst(scores: pd.DataFrame) -> int | None:
    """The answered frame that is furthest beyond one of the limits of a wrong answer; a wrong ring counts as one limit."""
    answered = scores[scores["outcome"] == "ok"]
    if answered.empty:
        return None
    beyond = pd.concat(
        [
            answered["geodesic_deg"] / WRONG_DEG,
            answered["position_error_m"] / (WRONG_OF_RANGE * answered["range_m"]),
            (answered["ring_right"] == 0.0).astype(float),
        ],
        axis=1,
    ).max(axis=1)
    return int(answered["frame"].to_list()[int(np.argmax(beyond.fillna(0.0).to_numpy()))])


def _caption(score: pd.Series, answers: Predictions, name: str) -> str:
    head = f"frame {score['frame']} ({name})"
    if score["outcome"] != "ok":
        return f"{head}: {score['outcome']}{reason(score, answers)}"
    x, y, z = (1e3 * score[f"ring_{axis}_error_m"] for axis in "xyz")
    placed = f"position {x:+.1f} {y:+.1f} {z:+.1f} mm, " if np.isfinite(x) else ""
    which = _RIGHT.get(score["ring_right"], "ring not given")
    angles = f"normal {score['normal_error_deg']:.2f}°, about the normal {score['about_normal_error_deg']:+.2f}°"
    return minus(f"{head}: {placed}{angles}; {which}")
