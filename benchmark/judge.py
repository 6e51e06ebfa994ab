"""Loop 2: a method's answers against the truth. One row per (frame, sensor, method), then one summary per sensor."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from benchmark import bound_scores, ring_scores, symmetry
from benchmark.angles import angle_of_axis
from benchmark.errors import PredictionsError
from benchmark.files import publish
from benchmark.filter_summary import FilterSummary
from benchmark.filter_track import filter_track
from benchmark.information import kept
from benchmark.pose_errors import attitude_errors, error_vectors, position_errors
from benchmark.predictions import Predictions, positions
from benchmark.records import KnowledgeRecord
from benchmark.ring_subject import LABELLING, RingSubject, subject_of
from benchmark.ring_summary import ring_summary
from benchmark.score_table import extras_of, opened
from benchmark.summary import Summary, figures
from scenes.dataset import Dataset
from scenes.errors import unknown
from scenes.features import RectangleFeature

SCORES, SUMMARY = "scores.parquet", "summary.json"


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """The score rows of all sensors and a summary for each."""

    scores: pd.DataFrame
    summaries: tuple[Summary, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Track:
    """One sensor's answers, scored."""

    scores: pd.DataFrame
    switches: int
    filter: FilterSummary | None = None


def judge(
    predictions: Predictions, dataset: Dataset, settle_s: float = 0.0, bounds: pd.DataFrame | None = None
) -> Judgement:
    """Scores every frame of ``dataset``. A frame without an answer is ``skipped`` and counts as a failure.

    The summary leaves out the first ``settle_s`` seconds, in which a suite lets filters settle; the score rows have all frames.
    ``bounds``: what ``hardlight bound`` found of the data set, left out what lies in its folder; where there is any, the score rows
    say how near the answers come to it.
    Raises ``PredictionsError`` where the answers belong to another data set, or name frames or sensors it does not have.
    """
    refuse_strangers(predictions, dataset)
    knowledge, scenario = predictions.record.knowledge, dataset.manifest.scenario
    ring, swept = subject_of(knowledge, dataset), swept_angle(scenario)
    bounds = kept.read(dataset) if bounds is None else bounds
    group = LABELLING if ring is not None else symmetry_of(knowledge, scenario)
    tables, summaries = [], []
    for sensor in dict.fromkeys(predictions.table["sensor"]):
        track = _track(predictions, dataset, str(sensor), group, ring, bounds)
        scores = track.scores
        settled = scores[scores["time_s"] >= scores["time_s"].min() + settle_s]
        if settled.empty:
            raise PredictionsError(f"the first {settle_s:g} s are not judged, and {dataset.path} has no frame after them")
        fields = figures(settled, swept) | {"label_switches": track.switches, "symmetry": group, "sensor": sensor}
        fields |= {"settle_s": settle_s, "filter": track.filter}
        if ring is not None:
            fields |= _of_ring(settled)
        tables.append(scores)
        summaries.append(Summary.model_validate(fields | _heading(predictions)))
    return Judgement(pd.concat(tables, ignore_index=True), tuple(summaries))


def write(folder: Path, judgement: Judgement) -> None:
    """Writes scores.parquet and summary.json (a list, one summary per sensor), both or none."""
    listed = [summary.model_dump(mode="json") for summary in judgement.summaries]
    text = json.dumps(listed, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    publish(folder, {SCORES: judgement.scores.to_parquet(index=False), SUMMARY: text.encode()})


def refuse_strangers(predictions: Predictions, dataset: Dataset) -> None:
    """Raises ``PredictionsError`` where the answers were not given on this data set."""
    answered, here = predictions.record.dataset_identity, dataset.identity
    if answered != here:
        raise PredictionsError(f"the predictions were made on data set {answered}, but {dataset.path} is data set {here}")
    strange = set(predictions.table["frame"]) - set(dataset.frames)
    if strange:
        raise PredictionsError(f"the predictions answer frame {min(strange)}, which {dataset.path} does not have")
    known = {*dataset.sensors, *dataset.lidars}
    for sensor in dict.fromkeys(predictions.table["sensor"]):
        if sensor not in known:
            raise PredictionsError(f"the predictions: {unknown('sensor', str(sensor), known)}")
    if predictions.table.empty:
        raise PredictionsError("the predictions have no line; a method answers every frame, if only with 'skipped'")


def symmetry_of(knowledge: KnowledgeRecord | None, scenario: Mapping[str, Any]) -> str:
    """The group that the errors are minimised over: none where labelled corners were granted, else the target's own."""
    if knowledge is not None and knowledge.corner_prior is not None:
        return "none"
    return str(scenario.get("target", {}).get("symmetry", "none"))


def swept_angle(scenario: Mapping[str, Any]) -> str | None:
    """The angle that the scenario's motion sweeps, None for another kind of motion."""
    motion = scenario.get("motion", {})
    return angle_of_axis(motion["axis"]) if motion.get("type") == "axis-sweep" else None


def _track(
    predictions: Predictions, dataset: Dataset, sensor: str, group: str, ring: RingSubject | None, bounds: pd.DataFrame | None
) -> _Track:
    """The score rows of one sensor, how often the labelling changed, and of a LIDAR what the states come to."""
    if sensor in dataset.lidars:
        return _Track(*filter_track(predictions, dataset, sensor, group, bounds))
    truth, table, scores = opened(predictions, dataset, sensor)
    answered = (table["outcome"] == "ok").to_numpy()
    labels = _labels(predictions, dataset, group) if ring is None else ring.labels
    elements = symmetry.group(group) if ring is None else ring.labels
    errors, switches = attitude_errors(truth, table, answered, elements, labels)
    true_m, given_m = (positions(one) if ring is None else ring.centres(one) for one in (truth, table))
    scores = scores.assign(**errors, **position_errors(true_m, given_m, errors["speed_rotation"]))
    vectors = error_vectors(truth, table, answered, elements, None if ring is None else np.array(ring.circle.centre_m))
    eye = sensor if ring is None else bound_scores.seen_by(dataset, sensor)
    scores = scores.assign(**bound_scores.columns(bounds, eye, truth.index, vectors))
    if ring is None:
        return _Track(scores, switches)
    extras = None if predictions.extras is None else extras_of(predictions, sensor, truth.index)
    scores = scores.assign(**ring_scores.columns(ring, dataset, truth, table, extras))
    return _Track(scores.assign(wrong=ring_scores.wrong(scores)), switches)


def _of_ring(settled: pd.DataFrame) -> dict[str, object]:
    """The fields of a summary that differ where the method was told of a ring."""
    wrong = int(np.nansum(settled["wrong"].to_numpy(dtype=np.float64)))
    return {"ring": ring_summary(settled), "wrong": wrong, "wrong_but_confident": wrong / len(settled)}


def _labels(predictions: Predictions, dataset: Dataset, group: str) -> Rotation:
    """The equivalent labellings whose changes are counted: the rectangle's four, or the target's symmetries."""
    knowledge = predictions.record.knowledge
    feature = next((one for one in dataset.features if knowledge is not None and one.name == knowledge.feature), None)
    if isinstance(feature, RectangleFeature):
        return symmetry.rectangle_labels(feature.target_from_feature)
    return symmetry.group(group)


def _heading(predictions: Predictions) -> dict[str, object]:
    record = predictions.record
    return {
        "method": record.method,
        "title": record.title,
        "dataset_identity": record.dataset_identity,
        "knowledge": record.knowledge,
        "start_cpu_s": record.start_cpu_s,
    }
