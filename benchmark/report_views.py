"""What the page shows of cases, gathered from a folder of results: a case holds features or LIDARs, each of which holds entries."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from benchmark.angles import ANGLE_NAMES, paper_angles
from benchmark.judge import swept_angle
from benchmark.leaderboard import Row, minus
from benchmark.report_lidar_pictures import intensity_tile
from benchmark.report_lidar_views import LidarView, lidar_views
from benchmark.report_pictures import Picture, glimpse
from benchmark.report_pooled import PooledLine, pooled_lines
from benchmark.report_rectangle_views import FeatureView, feature_view
from benchmark.report_ring_views import RingView, ring_view
from benchmark.results import Results
from benchmark.slugs import slugs
from benchmark.suite import Published
from scenes.dataset import Dataset


@dataclass(frozen=True, slots=True, eq=False)
class CaseView:
    """One case: its heading, its rectangles, its rings, its LIDARs, what a paper printed for it, where its pictures come from.

    The seeds of one case are one view, whose ``dataset`` is the first seed's. A case that asks cameras with several seeds has
    ``lines`` instead of features, rings and LIDARs: a page that showed every one of its plots would be too large to open.
    """

    name: str
    slug: str
    description: str
    seeds: tuple[int, ...]
    methods: tuple[tuple[str, int], ...]
    features: tuple[FeatureView, ...]
    rings: tuple[RingView, ...]
    lidars: tuple[LidarView, ...]
    lines: tuple[PooledLine, ...]
    published: tuple[Published, ...]
    dataset: Dataset
    glimpses: tuple[Picture, ...]

    @property
    def seeds_text(self) -> str:
        """The seed, or the seeds where there are several data sets."""
        if len(self.seeds) < 2:
            return f"seed {self.dataset.manifest.seed}"
        return f"seeds {', '.join(map(str, self.seeds))} (the digests are the first's)"


def cases(folder: Path, index: Results, rows: Sequence[Row], frames: pd.DataFrame, titles: Sequence[str]) -> list[CaseView]:
    """Every case of ``index``; a method's place in ``titles`` is its colour. ``frames`` are ``benchmark.pool.pool``'s."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(index.bases.get(row.entry.case, row.entry.case), []).append(row)
    ids = slugs(list(groups), "case-")
    return [_case(folder, index, name, ids[name], mine, frames[frames["case"] == name], titles) for name, mine in groups.items()]


def _case(
    folder: Path, index: Results, name: str, slug: str, mine: Sequence[Row], frames: pd.DataFrame, titles: Sequence[str]
) -> CaseView:
    dataset = Dataset.open(folder / mine[0].entry.dataset)
    of_cameras = [row for row in mine if row.summary.filter is None]
    is_compact = bool(of_cameras) and len({row.entry.case for row in mine}) > 1
    shown = ((), (), ()) if is_compact else _detailed(folder, index, name, dataset, mine, titles)
    answering = {row.entry.title for row in mine}
    seen = tuple(_glimpses(dataset)) if dataset.sensors else tuple(_scans(dataset, mine))
    return CaseView(
        name=name,
        slug=slug,
        description=next(case.description for case in index.cases if case.name == mine[0].entry.case),
        seeds=_seeds(index, mine),
        methods=tuple((title, series) for series, title in enumerate(titles) if title in answering),
        features=shown[0],
        rings=shown[1],
        lidars=shown[2],
        lines=tuple(pooled_lines(frames, titles)) if is_compact else (),
        published=tuple(one for one in index.published if one.case == name),
        dataset=dataset,
        glimpses=seen[len(seen) // 2 :][:1] if is_compact else seen,
    )


def _detailed(
    folder: Path, index: Results, name: str, dataset: Dataset, mine: Sequence[Row], titles: Sequence[str]
) -> tuple[tuple[FeatureView, ...], tuple[RingView, ...], tuple[LidarView, ...]]:
    """Tables, plots and pictures of everything that one case asks for."""
    features, rings = [], []
    for _, group in groupby((row for row in mine if row.summary.filter is None), key=lambda row: row.entry.feature):
        listed = list(group)
        if listed[0].summary.ring is not None:
            rings.append(ring_view(folder, index, dataset, listed, titles))
        else:
            features.append(feature_view(folder, dataset, listed, titles))
    scanned = [row for row in mine if row.summary.filter is not None]
    return tuple(features), tuple(rings), lidar_views(folder, index, name, scanned, titles)


def _seeds(index: Results, mine: Sequence[Row]) -> tuple[int, ...]:
    known = {case.name: case.seed for case in index.cases}
    seeds = (known.get(name) for name in dict.fromkeys(row.entry.case for row in mine))
    return tuple(seed for seed in seeds if seed is not None)


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
