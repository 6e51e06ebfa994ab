"""Loop 2: a method's answers against the truth. One row per (frame, sensor, method), then one summary per sensor."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from benchmark import metrics, symmetry
from benchmark.angles import ANGLE_NAMES, angle_of_axis, paper_angles, wrapped
from benchmark.errors import PredictionsError
from benchmark.files import publish
from benchmark.predictions import QUATERNION, TRANSLATION, Predictions
from benchmark.records import KnowledgeRecord
from benchmark.summary import Summary, figures
from scenes.dataset import Dataset
from scenes.errors import unknown

SCORES, SUMMARY = "scores.parquet", "summary.json"
# What the truth table says of a frame's light and view; kept beside the errors so that studies can ask what drove them.
_CONDITIONS = (
    "time_s", "range_m", "phase_angle_deg", "visible_fraction", "lit_fraction", "shadow_fraction", "specular_fraction",
    "saturated_fraction",
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """The score rows of all sensors and a summary for each."""

    scores: pd.DataFrame
    summaries: tuple[Summary, ...]


def judge(predictions: Predictions, dataset: Dataset, settle_s: float = 0.0) -> Judgement:
    """Scores every frame of ``dataset``. A frame without an answer is ``skipped`` and counts as a failure.

    The summary leaves out the first ``settle_s`` seconds, in which a suite lets filters settle; the score rows have all frames.
    Raises ``PredictionsError`` where the answers belong to another data set, or name frames or sensors it does not have.
    """
    refuse_strangers(predictions, dataset)
    knowledge, scenario = predictions.record.knowledge, dataset.manifest.scenario
    group, swept = symmetry_of(knowledge, scenario), swept_angle(scenario)
    tables, summaries = [], []
    for sensor in dict.fromkeys(predictions.table["sensor"]):
        scores, switches = _track(predictions, dataset, str(sensor), group)
        settled = scores[scores["time_s"] >= scores["time_s"].min() + settle_s]
        if settled.empty:
            raise PredictionsError(f"the first {settle_s:g} s are not judged, and {dataset.path} has no frame after them")
        fields = figures(settled, swept) | {"label_switches": switches, "symmetry": group, "sensor": sensor}
        fields |= {"settle_s": settle_s}
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
    for sensor in dict.fromkeys(predictions.table["sensor"]):
        if sensor not in dataset.sensors:
            raise PredictionsError(f"the predictions: {unknown('sensor', str(sensor), dataset.sensors)}")
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


def _track(predictions: Predictions, dataset: Dataset, sensor: str, group: str) -> tuple[pd.DataFrame, int]:
    """The score rows of one sensor, and how often the labelling changed."""
    table = predictions.table[predictions.table["sensor"] == sensor].set_index("frame")
    truth = dataset.truth_table()
    truth = truth[truth["sensor"] == sensor].set_index("frame").sort_index()
    table = table.reindex(truth.index)
    outcome = table["outcome"].fillna("skipped")
    answered = (outcome == "ok").to_numpy()
    scores = pd.DataFrame({"frame": truth.index, "sensor": sensor, "method": predictions.record.title})
    scores["outcome"] = outcome.to_numpy()
    scores[["cpu_s", "wall_s"]] = table[["cpu_s", "wall_s"]].to_numpy(dtype=np.float64)
    for name in _CONDITIONS:
        scores[name] = truth[name].to_numpy() if name in truth else np.nan
    errors, switches = _attitude_errors(truth, table, answered, symmetry.group(group), _labels(predictions, dataset, group))
    return scores.assign(**errors, **_position_errors(truth, table, errors["speed_rotation"])), switches


def _labels(predictions: Predictions, dataset: Dataset, group: str) -> Rotation:
    """The equivalent labellings whose changes are counted: the rectangle's four, or the target's symmetries."""
    knowledge = predictions.record.knowledge
    features = {feature.name: feature for feature in dataset.features}
    if knowledge is not None and knowledge.feature in features:
        return symmetry.rectangle_labels(features[knowledge.feature].target_from_feature)
    return symmetry.group(group)


def _attitude_errors(
    truth: pd.DataFrame, table: pd.DataFrame, answered: np.ndarray, elements: Rotation, labels: Rotation
) -> tuple[dict[str, np.ndarray], int]:
    """Geodesic and Z-Y-X angle errors in degrees, NaN where not answered; the track's group element is divided out."""
    true = _rotations(truth)
    columns = {f"{name}_deg": np.degrees(angle) for name, angle in zip(ANGLE_NAMES, paper_angles(true).T, strict=True)}
    empty = ("geodesic_deg", *(f"{name}_error_deg" for name in ANGLE_NAMES), "speed_rotation", "label")
    columns |= {name: np.full(len(truth), np.nan) for name in empty}
    if not answered.any():
        return columns, 0
    true, given = true[answered], _rotations(table[answered])
    relabelled = given * elements[symmetry.track_element(true, given, elements)].inv()
    geodesic = metrics.geodesic(true, relabelled)
    columns["geodesic_deg"][answered] = np.degrees(geodesic)
    columns["speed_rotation"][answered] = metrics.speed_rotation(geodesic)
    errors = np.degrees(wrapped(paper_angles(relabelled) - paper_angles(true)))
    for name, error in zip(ANGLE_NAMES, errors.T, strict=True):
        columns[f"{name}_error_deg"][answered] = error
    columns["label"][answered] = frame_labels = symmetry.frame_labels(true, given, labels)
    return columns, symmetry.label_switches(frame_labels)


def _position_errors(truth: pd.DataFrame, table: pd.DataFrame, speed_rotation: np.ndarray) -> dict[str, np.ndarray]:
    """Position error in metres and the SPEED scores, NaN where a method gives no position."""
    true, given = (one[list(TRANSLATION)].to_numpy(dtype=np.float64) for one in (truth, table))
    position = metrics.speed_position(true, given)
    position[np.isnan(given).any(axis=1)] = np.nan
    return {
        "position_error_m": np.linalg.norm(given - true, axis=1),
        "speed_position": position,
        "speed_score": speed_rotation + position,
    }


def _rotations(table: pd.DataFrame) -> Rotation:
    return Rotation.from_quat(table[list(QUATERNION)].to_numpy(dtype=np.float64), scalar_first=True)


def _heading(predictions: Predictions) -> dict[str, object]:
    record = predictions.record
    return {
        "method": record.method,
        "title": record.title,
        "dataset_identity": record.dataset_identity,
        "knowledge": record.knowledge,
        "start_cpu_s": record.start_cpu_s,
    }
