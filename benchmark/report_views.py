"""What the page shows, gathered from a folder of results: a case holds features or LIDARs, each of which holds entries."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from benchmark import predictions
from benchmark.angles import ANGLE_NAMES, paper_angles
from benchmark.judge import SCORES, swept_angle
from benchmark.leaderboard import Row, minus, rows
from benchmark.predictions import Predictions
from benchmark.report_lidar_pictures import intensity_tile
from benchmark.report_lidar_views import LidarEntryView, LidarView, lidar_views
from benchmark.report_pictures import Picture, glimpse, picture
from benchmark.report_plots import Track, error_plot
from benchmark.report_ring_views import RingEntryView, RingView, reason, ring_view
from benchmark.results import Results
from benchmark.suite import Published
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


@dataclass(frozen=True, slots=True, eq=False)
class CaseView:
    """One case: its heading, its rectangles, its rings, its LIDARs, what a paper printed for it, where its pictures come from.

    The seeds of one LIDAR case are one view, whose ``dataset`` is the first seed's.
    """

    name: str
    description: str
    methods: tuple[tuple[str, int], ...]
    features: tuple[FeatureView, ...]
    rings: tuple[RingView, ...]
    lidars: tuple[LidarView, ...]
    published: tuple[Published, ...]
    dataset: Dataset
    glimpses: tuple[Picture, ...]

    @property
    def seeds_text(self) -> str:
        """The seed, or the seeds where there are several data sets."""
        seeds = next((view.seeds for view in self.lidars if len(view.seeds) > 1), ())
        if not seeds:
            return f"seed {self.dataset.manifest.seed}"
        return f"seeds {', '.join(map(str, seeds))} (the digests are the first's)"

    @property
    def entries(self) -> tuple[EntryView | RingEntryView | LidarEntryView, ...]:
        """Every row of the case's tables."""
        rectangles = [entry for view in self.features for entry in view.entries]
        rings = [entry for view in self.rings for entry in view.entries]
        return (*rectangles, *rings, *(entry for view in self.lidars for entry in view.entries))


def cases(folder: Path, index: Results, titles: Sequence[str]) -> list[CaseView]:
    """Every case of ``index``; a method's place in ``titles`` is its colour."""
    groups: dict[str, list[Row]] = {}
    for row in rows(folder, index):
        shared = row.summary.filter is not None
        groups.setdefault(index.bases.get(row.entry.case, row.entry.case) if shared else row.entry.case, []).append(row)
    return [_case(folder, index, name, mine, titles) for name, mine in groups.items()]


def _case(folder: Path, index: Results, name: str, mine: Sequence[Row], titles: Sequence[str]) -> CaseView:
    dataset = Dataset.open(folder / mine[0].entry.dataset)
    heading = next(case for case in index.cases if case.name == mine[0].entry.case)
    features, rings = [], []
    of_lidars = [row for row in mine if row.summary.filter is not None]
    for feature, group in groupby((row for row in mine if row.summary.filter is None), key=lambda row: row.entry.feature):
        listed = list(group)
        if listed[0].summary.ring is not None:
            rings.append(ring_view(folder, index, dataset, listed, titles))
            continue
        entries = tuple(_entry(folder, dataset, row, titles.index(row.entry.title)) for row in listed)
        plot = _plot(entries, swept_angle(dataset.manifest.scenario), f"{name}-{feature}")
        features.append(FeatureView(feature or "", plot, entries))
    published = tuple(one for one in index.published if one.case == name)
    methods = tuple((title, series) for series, title in enumerate(titles) if title in {row.entry.title for row in mine})
    views = tuple(features), tuple(rings), lidar_views(folder, index, name, of_lidars, titles)
    seen = tuple(_glimpses(dataset)) if dataset.sensors else tuple(_scans(dataset, of_lidars))
    return CaseView(name, heading.description, methods, *views, published, dataset, seen)


def _scans(dataset: Dataset, mine: Sequence[Row]) -> Iterator[Picture]:
    """The first, the middle and the last scan of the LIDAR that was judged."""
    frames, lidar = dataset.frames, mine[0].summary.sensor
    for frame in sorted({frames[0], frames[len(frames) // 2], frames[-1]}):
        tile = intensity_tile(dataset, lidar, frame, f"frame {frame}, strength of the returns")
        yield Picture(tile.uri, tile.width, tile.height, truth="", answer="", caption=tile.label, is_failure=False)


def _glimpses(dataset: Dataset) -> Iterator[Picture]:
    """The first and the last frame, between them the one with the most saturated pixels, else the middle one."""
    frames, swept = dataset.frames, swept_angle(dataset.manifest.scenario)
    saturated = dataset.truth_table().groupby("frame")["saturated_fraction"].max()
    between = frames[int(np.nanargmax(saturated.to_numpy()))] if saturated.max() > 0 else frames[len(frames) // 2]
    for frame in sorted({frames[0], between, frames[-1]}):
        pose = dataset.truth(frame).sensor_from_target[next(iter(dataset.sensors))]
        angle = "" if swept is None else f", θ = {_degrees(pose.rotation, swept):.1f}°"
        yield glimpse(dataset, frame, minus(f"frame {frame}{angle}"))


def _degrees(cam_from_target: Rotation, name: str) -> float:
    return round(float(np.degrees(paper_angles(cam_from_target)[0, ANGLE_NAMES.index(name)])), 1) + 0.0  # no minus zero


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
    return error_plot(tracks, salt)


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


def is_constant(summary: Summary) -> bool:
    """Whether most answers are zero although the target turns."""
    swept = summary.swept
    return swept is not None and summary.answered >= 3 and swept.near_zero_answers > summary.answered / 2


def told(cases: Sequence[CaseView]) -> dict[str, list[str]]:
    """Method → everything that it was told in any case, each fact once."""
    told: dict[str, list[str]] = {}
    for case in cases:
        for entry in case.entries:
            knowledge = entry.row.summary.knowledge
            facts = knowledge.facts(named=False) if knowledge is not None else ["not declared"]
            known = told.setdefault(entry.row.entry.title, [])
            known += [fact for fact in facts if fact not in known]
    return told
