"""The frames behind a study's points: of each a card with what the sensors saw and what the methods made of it."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmark.gallery_outlines import feature_points
from benchmark.gallery_window import around
from benchmark.ranking_cells import short
from benchmark.report_pictures import data_uri, fitted, shown
from benchmark.study.outcomes import Outcomes
from benchmark.subjects import NAMES
from scenes.dataset import Dataset

_WIDEST_PX, _QUALITY = 230, 55
_MOST = 400  # cards with pictures: the page stays small
_WIDTHS = {100: 230, 200: 170, _MOST: 120}  # up to so many points, so wide


@dataclass(frozen=True, slots=True, eq=False)
class Glimpse:
    """One camera's picture of the target as a link, ``width`` × ``height`` px."""

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
        frame = int((asked if len(asked) else frames)["frame"].iloc[0])
        yield Card(str(row.point), str(row.label), frame, tuple(glimpses(folder, frames, frame, width)), tuple(_lines(frames)))


def glimpses(folder: Path, frames: pd.DataFrame, frame: int, width_px: int = _WIDEST_PX) -> Iterator[Glimpse]:
    """What every camera saw in a frame, cut out around the target's features."""
    path = folder / str(frames["dataset"].iloc[0])
    if width_px == 0 or not (path / "frames").is_dir():
        return
    dataset = Dataset.open(path)
    poses, images = dataset.truth(frame).sensor_from_target, dataset.observation(frame).images
    for camera, model in dataset.sensors.items():
        points = [model.intrinsics.project(poses[camera].apply(feature_points(one))) for one in dataset.features]
        lens = model.intrinsics
        window = around(np.vstack(points) if points else np.empty((0, 2)), lens)
        pixels = fitted(shown(window.cut(images[camera].pixels), model), width_px)
        yield Glimpse(camera, data_uri(pixels, _QUALITY), pixels.shape[1], pixels.shape[0])


def _lines(frames: pd.DataFrame) -> Iterator[Line]:
    for (modality, method), mine in frames.groupby(["modality", "method"], sort=False):
        right, known = mine[mine["right"]], mine["bound_rotation_rad"].dropna()
        bound = "not asked for" if not mine["bound_asked"].any() else "undetermined"
        yield Line(
            modality=NAMES[str(modality)],
            method=str(method),
            right=f"{len(right)} of {len(mine)}",
            error=f"{short(float(right['geodesic_deg'].median()))}°" if len(right) else "—",
            bound=f"{short(float(np.degrees(known.median())))}°" if len(known) else bound,
            charge=short(1000 * float(mine["charge"].mean())),
        )
