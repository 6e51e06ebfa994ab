"""The information limit of what suites and studies run: found once, kept as bounds/<run>.parquet."""

from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from benchmark.case import Case
from benchmark.information import kept
from benchmark.progress import Progress
from scenes.dataset import Dataset
from scenes.dataset_range import parse_frames

FOLDER = "bounds"


def bounded(
    dataset: Path, out: Path, run: str, frames: str, samples: int, case: Case, progress: Progress | None = None
) -> None:
    """Finds the bounds of the data set's ``frames`` (by place) with the sensors that ``case`` asks for, unless they lie there.

    ``samples``: of each pixel in each of a bound's renderings.
    """
    there = Dataset.open(dataset)
    chosen = [there.frames[at] for at in parse_frames(frames, len(there.frames))]
    name = path_of(out, run).name
    kept.completed(there, out / FOLDER, chosen, sensors_of(case), progress, samples=samples, name=name, alone=True)


def path_of(out: Path, run: str) -> Path:
    """Where the bounds of one run lie."""
    return out / FOLDER / f"{run}.parquet"


def read(out: Path, run: str) -> pd.DataFrame | None:
    """The bounds of one run, None where none were asked for."""
    path = path_of(out, run)
    return pd.read_parquet(path) if path.is_file() else None


def forget(out: Path, runs: Iterable[str]) -> None:
    """Removes bounds that nobody asks for any more, which would be read as if somebody had."""
    for run in runs:
        path_of(out, run).unlink(missing_ok=True)


def sensors_of(case: Case) -> list[str]:
    """The cameras, rigs and LIDARs that answer what a case asks for: every single camera for rectangles."""
    modalities = {subject.modality for subject in case.subjects}
    cameras = sorted(case.scenario.cameras) if "mono" in modalities else []
    rigs = ([case.rig] if case.rig else sorted(case.scenario.rigs)) if "stereo" in modalities else []
    lidars = [subject.lidar for subject in case.subjects if subject.lidar is not None]
    return [*cameras, *rigs, *lidars]
