"""What the page shows of a case's rectangle: the rows of its table, the error plot, the pictures behind the worst frames."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from benchmark import predictions
from benchmark.judge import SCORES, swept_angle
from benchmark.leaderboard import Row, minus
from benchmark.predictions import Predictions
from benchmark.report_pictures import Picture, picture
from benchmark.report_plots import Track, error_plot
from benchmark.report_ring_views import reason
from benchmark.summary import Summary
from scenes.dataset import Dataset
from scenes.features import RectangleFeature

_PICTURES_PER_ENTRY = 2


@dataclass(frozen=True, slots=True, eq=False)
class EntryView:
    """One row of the page: the row of the table, what the method was told, and the pictures behind its worst frames."""

    row: Row
    series: int
    answers: Predictions
    scores: pd.DataFrame
    pictures: tuple[Picture, ...]


@dataclass(frozen=True, slots=True, eq=False)
class FeatureView:
    """Everything about one feature of one case."""

    name: str
    plot: str
    entries: tuple[EntryView, ...]


def feature_view(folder: Path, dataset: Dataset, rows: Sequence[Row], titles: Sequence[str]) -> FeatureView:
    """The view of the ``rows`` of one rectangle; a method's place in ``titles`` is its colour."""
    case, feature = rows[0].entry.case, rows[0].entry.feature
    entries = tuple(_entry(folder, dataset, row, titles.index(row.entry.title)) for row in rows)
    plot = _plot(entries, swept_angle(dataset.manifest.scenario), f"{case}-{feature}")
    return FeatureView(feature or "", plot, entries)


def is_constant(summary: Summary) -> bool:
    """Whether most answers are zero although the target turns."""
    swept = summary.swept
    return swept is not None and summary.answered >= 3 and swept.near_zero_answers > summary.answered / 2


def _entry(folder: Path, dataset: Dataset, row: Row, series: int) -> EntryView:
    answers = predictions.read(folder / row.entry.answers)
    scores = pd.read_parquet(folder / row.entry.scores / SCORES)
    scores = scores[scores["sensor"] == row.summary.sensor]
    return EntryView(row, series, answers, scores, tuple(_pictures(dataset, row, answers, scores)))


def _plot(entries: Sequence[EntryView], swept: str | None, salt: str) -> str:
    """The error plot of a feature, empty where the scenario sweeps no angle."""
    if swept is None:
        return ""
    tracks = [
        Track(
            title=entry.row.entry.title,
            series=entry.series,
            truth_deg=entry.scores[f"{swept}_deg"].to_numpy(),
            error_deg=entry.scores[f"{swept}_error_deg"].to_numpy(),
            answered=(entry.scores["outcome"] == "ok").to_numpy(),
        )
        for entry in entries
    ]
    return error_plot(tracks, salt, f"{salt}: error against angle for {len(tracks)} methods")


def _pictures(dataset: Dataset, row: Row, answers: Predictions, scores: pd.DataFrame) -> Iterator[Picture]:
    """The worst answered frame and the first unanswered one; where all are answered, the two worst."""
    features = {feature.name: feature for feature in dataset.features}
    feature = features.get(row.entry.feature or "")
    if not isinstance(feature, RectangleFeature):
        return
    answered = scores[scores["outcome"] == "ok"].sort_values("geodesic_deg", ascending=False, kind="stable")
    failed = scores[scores["outcome"] != "ok"]
    shown = pd.concat([answered.head(_PICTURES_PER_ENTRY - min(1, len(failed))), failed.head(1)])
    table = answers.table.set_index("frame", drop=False)
    for _, score in shown.iterrows():
        answer = table.loc[score["frame"]] if score["frame"] in table.index else score
        yield picture(dataset, feature, answer, _caption(score, answers, row))


def _caption(score: pd.Series, answers: Predictions, row: Row) -> str:
    swept = row.summary.swept
    theta = f", θ = {round(score[f'{swept.name}_deg'], 1) + 0.0:.1f}°" if swept is not None else ""
    head = minus(f"frame {score['frame']}{theta}")
    if score["outcome"] != "ok":
        return f"{head}: {score['outcome']}{reason(score, answers)}"
    signed = minus(f"error {score[f'{swept.name}_error_deg']:+.2f}°, ") if swept is not None else ""
    return f"{head}: {signed}geodesic {score['geodesic_deg']:.2f}°"
