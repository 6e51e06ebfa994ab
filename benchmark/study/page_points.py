"""The frames behind a study's points: of each a card with what the sensors saw and what the methods made of it."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmark.gallery_answers import Answers, Said
from benchmark.gallery_lidars import lidar_views
from benchmark.gallery_outlines import feature_points
from benchmark.gallery_window import around
from benchmark.ranking_cells import short
from benchmark.report_pictures import data_uri, fitted, shown
from benchmark.study.outcomes import Outcomes
from benchmark.subjects import NAMES
from scenes.dataset import Dataset
from scenes.errors import DatasetError

_QUALITY = 55
_WIDTHS = {40: 380, 100: 300, 200: 200, 400: 130}  # up to so many points, so wide: the page stays small
_NOTHING = Said(None, None, "", {})


@dataclass(frozen=True, slots=True, eq=False)
class Glimpse:
    """What one camera or LIDAR saw of the target as a link, ``width`` × ``height`` px."""

    camera: str
    uri: str
    width: int
    height: int


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """What one method made of a point, as texts."""

    modality: str
    method: str
    right: str
    error: str
    bound: str
    charge: str


@dataclass(frozen=True, slots=True, eq=False)
class Card:
    """One point: its name and setting, pictures of one of its frames, a line per method."""

    name: str
    label: str
    dataset: str
    frame: int
    glimpses: tuple[Glimpse, ...]
    lines: tuple[Line, ...]


def cards(folder: Path, found: Outcomes) -> Iterator[Card]:
    """Every point once, in the design's order; without pictures where the data sets are not there."""
    by_point = {str(name): rows for name, rows in found.frames.groupby("point", sort=False)}
    width = next((px for most, px in _WIDTHS.items() if found.points["point"].nunique() <= most), 0)
    for row in found.points.drop_duplicates("point").itertuples():
        frames = by_point.get(str(row.point))
        if frames is None:
            continue
        asked = frames[frames["bound_asked"]]
        first = (asked if len(asked) else frames).iloc[0]
        same = frames[(frames["run"] == first["run"]) & (frames["frame"] == first["frame"])]
        seen = tuple(glimpses(folder, same, width)) if width else ()
        yield Card(str(row.point), str(row.label), str(first["dataset"]), int(first["frame"]), seen, tuple(_lines(frames)))


def glimpses(folder: Path, rows: pd.DataFrame, width_px: int) -> Iterator[Glimpse]:
    """What every camera saw in one frame, cut out around the target's features, then what every asked LIDAR did.

    ``rows``: of the pooled frames, those of this frame. Nothing where the data set is not there.
    """
    answers = Answers(folder)
    try:
        dataset = answers.dataset(rows.iloc[0])
        yield from _pictures(dataset, int(rows["frame"].iloc[0]), width_px)
        for _, row in rows[rows["modality"] == "lidar"].drop_duplicates("sensor").iterrows():
            for view in lidar_views(answers, row, _NOTHING):
                yield Glimpse(view.name, view.layers[0].uri, view.width, view.height)
    except DatasetError:
        return


def _pictures(dataset: Dataset, frame: int, width_px: int) -> Iterator[Glimpse]:
    poses, images = dataset.truth(frame).sensor_from_target, dataset.observation(frame).images
    for camera, model in dataset.sensors.items():
        points = [model.intrinsics.project(poses[camera].apply(feature_points(one))) for one in dataset.features]
        window = around(np.vstack(points) if points else np.empty((0, 2)), model.intrinsics)
        pixels = fitted(shown(window.cut(images[camera].pixels), model), width_px)
        yield Glimpse(camera, data_uri(pixels, _QUALITY), pixels.shape[1], pixels.shape[0])


def _lines(frames: pd.DataFrame) -> Iterator[Line]:
    for (modality, method), mine in frames.groupby(["modality", "method"], sort=False):
        right = mine[mine["right"]]
        yield Line(
            modality=NAMES[str(modality)],
            method=str(method),
            right=f"{len(right)} of {len(mine)}",
            error=f"{short(float(right['geodesic_deg'].median()))}°" if len(right) else "—",
            bound=_bound(mine),
            charge=short(1000 * float(mine["charge"].mean())),
        )


def _bound(frames: pd.DataFrame) -> str:
    """The median over the frames that were asked about; one whose pose is undetermined is above all others."""
    asked = frames.loc[frames["bound_asked"].astype(bool), "bound_rotation_rad"].fillna(np.inf)
    if not len(asked):
        return "not asked for"
    median = float(asked.median())
    return f"{short(float(np.degrees(median)))}°" if np.isfinite(median) else "undetermined"
