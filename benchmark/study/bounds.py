"""The information limit of a study's data sets: found once, kept as bounds/<run>.parquet beside what they follow from."""

from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from benchmark.case import Case
from benchmark.files import publish
from benchmark.progress import Progress
from scenes.dataset import Dataset
from scenes.dataset_range import parse_frames
from scenes.provenance import sha256_of_json, software_versions

FOLDER = "bounds"


def bounded(
    dataset: Path, out: Path, run: str, frames: str, samples: int, case: Case, progress: Progress | None = None
) -> None:
    """Finds the bounds of the data set's ``frames`` (by place) with the sensors that ``case`` asks for, unless they lie there.

    ``samples``: of each pixel in each of a bound's renderings.
    """
    there = Dataset.open(dataset)
    stamp = sha256_of_json([there.identity, frames, samples, sensors_of(case), software_versions()])
    mark = out / FOLDER / f"{run}.sha256"
    if mark.is_file() and mark.read_text(encoding="utf-8") == stamp and (out / FOLDER / f"{run}.parquet").is_file():
        return
    from benchmark.information.table import bounds_table

    chosen = [there.frames[at] for at in parse_frames(frames, len(there.frames))]
    found = bounds_table(there, chosen, progress, sensors=sensors_of(case), samples=samples)
    publish(out / FOLDER, {f"{run}.parquet": found.to_parquet(index=False), f"{run}.sha256": stamp.encode()})


def path_of(out: Path, run: str) -> Path:
    """Where the bounds of one run lie."""
    return out / FOLDER / f"{run}.parquet"


def read(out: Path, run: str) -> pd.DataFrame | None:
    """The bounds of one run, None where none were asked for."""
    path = out / FOLDER / f"{run}.parquet"
    return pd.read_parquet(path) if path.is_file() else None


def forget(out: Path, runs: Iterable[str]) -> None:
    """Removes bounds that nobody asks for any more, which would be read as if somebody had."""
    for run in runs:
        for ending in ("parquet", "sha256"):
            (out / FOLDER / f"{run}.{ending}").unlink(missing_ok=True)


def sensors_of(case: Case) -> list[str]:
    """The cameras, rigs and LIDARs that answer what a case asks for: every single camera for rectangles."""
    modalities = {subject.modality for subject in case.subjects}
    cameras = sorted(case.scenario.cameras) if "mono" in modalities else []
    rigs = ([case.rig] if case.rig else sorted(case.scenario.rigs)) if "stereo" in modalities else []
    lidars = [subject.lidar for subject in case.subjects if subject.lidar is not None]
    return [*cameras, *rigs, *lidars]
