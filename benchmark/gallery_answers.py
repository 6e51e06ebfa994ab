"""What a method said of one frame: its pose in the target's frame, its reason, its named numbers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark import predictions, symmetry
from benchmark.filter_gauge import gauge_of, in_target_frame
from benchmark.judge import symmetry_of
from benchmark.predictions import Predictions, positions, rotations
from benchmark.ring_subject import RingSubject, subject_of
from benchmark.score_table import in_order
from scenes.arrays import Floats
from scenes.dataset import Dataset
from scenes.features import Feature
from scenes.provenance import sha256_of_json
from scenes.solids import Solid, solids
from scenes.target import Target


@dataclass(frozen=True, slots=True, eq=False)
class Said:
    """``rotation``, ``position_m``: sensor_from_target as the judge reads it; None where there is none. ``extras``: the numbers."""

    rotation: Rotation | None
    position_m: Floats | None
    reason: str
    extras: Mapping[str, float]

    def pose(self, true: RigidTransform, pivot_target: Floats) -> RigidTransform | None:
        """The answered pose; without a position, about the true place of the point ``pivot_target`` (3,)."""
        if self.rotation is None:
            return None
        position_m = self.position_m
        if position_m is None:
            position_m = true.apply(pivot_target) - self.rotation.apply(pivot_target)
        return RigidTransform.from_components(position_m, self.rotation)


@dataclass(slots=True, eq=False)
class Answers:
    """The answers of a folder of results, each file read once."""

    folder: Path
    _read: dict[str, Predictions] = field(default_factory=dict)
    _open: dict[str, Dataset] = field(default_factory=dict)
    _solids: dict[str, tuple[Solid, ...]] = field(default_factory=dict)

    def dataset(self, row: pd.Series) -> Dataset:
        """The data set of a pooled row. Raises ``DatasetError`` where it is not there."""
        name = str(row["dataset"])
        if name not in self._open:
            self._open[name] = Dataset.open(self.folder / name)
        return self._open[name]

    def of(self, row: pd.Series) -> Said:
        """What was said of a pooled row's frame. Raises ``PredictionsError`` where the answers are lost."""
        given, dataset, frame = self._answers(row), self.dataset(row), int(row["frame"])
        extras = None if given.extras is None else in_order(given.extras, row["sensor"], pd.Index([frame])).iloc[0]
        if not row["answered"]:
            return Said(None, None, *_named(extras))
        rotation, position_m = _placed(given, dataset, row)
        return Said(rotation, position_m, *_named(extras))

    def ring(self, row: pd.Series) -> RingSubject | None:
        """The ring that the method was asked for."""
        return subject_of(self._answers(row).record.knowledge, self.dataset(row))

    def solids(self, dataset: Dataset) -> tuple[Solid, ...]:
        """The target's triangles; none where the scenario says of a target no more than its features."""
        target = dataset.manifest.scenario.get("target")
        if not isinstance(target, dict) or "parts" not in target:
            return ()
        digest = sha256_of_json(target)
        if digest not in self._solids:
            self._solids[digest] = solids(Target.model_validate(dataset.scenario["target"]))
        return self._solids[digest]

    def _answers(self, row: pd.Series) -> Predictions:
        name = str(row["answers"])
        if name not in self._read:
            self._read[name] = predictions.read(self.folder / name)
        return self._read[name]


def feature_of(dataset: Dataset, subject: str) -> Feature | None:
    """The feature that a pooled row speaks of, None for a LIDAR."""
    return next((one for one in dataset.features if one.name == subject), None)


def _named(extras: pd.Series | None) -> tuple[str, dict[str, float]]:
    """The reason and the numbers."""
    if extras is None:
        return "", {}
    reason = extras.get("reason", "")
    numbers = {str(name): float(value) for name, value in extras.items() if isinstance(value, int | float | np.number)}
    return (reason if isinstance(reason, str) else ""), numbers


def _placed(given: Predictions, dataset: Dataset, row: pd.Series) -> tuple[Rotation, Floats | None]:
    """The answer to a frame in the labelling that the judge chose for its track, so that a picture shows what the score says."""
    sensor, frame, knowledge = str(row["sensor"]), int(row["frame"]), given.record.knowledge
    truth = dataset.truth_table()
    truth = truth[truth["sensor"] == sensor].set_index("frame").sort_index()
    table = in_order(given.table, sensor, truth.index)
    table["outcome"] = table["outcome"].fillna("skipped")
    group = symmetry_of(knowledge, dataset.manifest.scenario)
    if sensor in dataset.lidars:
        told = knowledge is not None and knowledge.model is not None
        return _pose(in_target_frame(table, gauge_of(truth, table, told_model=told, group=group)), frame)
    ring = subject_of(knowledge, dataset)
    elements = symmetry.group(group) if ring is None else ring.labels
    answered = (table["outcome"] == "ok").to_numpy()
    chosen = elements[symmetry.track_element(rotations(truth[answered]), rotations(table[answered]), elements)]
    rotation, position_m = _pose(table, frame)
    turned = rotation * chosen.inv()
    if position_m is not None and ring is not None:  # the turn is about the ring's axis, not about the target's origin
        position_m = position_m + rotation.apply(ring.circle.centre_m) - turned.apply(ring.circle.centre_m)
    return turned, position_m


def _pose(table: pd.DataFrame, frame: int) -> tuple[Rotation, Floats | None]:
    row = table.loc[[frame]]
    rotation, position_m = rotations(row)[0], positions(row)[0]
    return rotation, position_m if np.isfinite(position_m).all() else None
