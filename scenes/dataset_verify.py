"""Whether a data set is what it says: every file against its digest, every number in the table against its frame."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from scenes.assets import asset_digest, mesh_paths
from scenes.atomic import leftovers
from scenes.dataset import Dataset
from scenes.dataset_frame import read_frame_json
from scenes.dataset_layout import (
    ASSETS,
    FRAME_FILE,
    FRAMES,
    MANIFEST,
    TEMPORARY,
    TRUTH_TABLE,
    beams_name,
    frame_folder,
    image_name,
    layers_name,
    scan_name,
)
from scenes.dataset_manifest import Manifest, read_manifest
from scenes.dataset_truth import rows
from scenes.dataset_writer import missing_sentence
from scenes.errors import AssetError, DatasetError
from scenes.provenance import sha256_of_bytes


def verify(path: Path) -> list[str]:
    """What is wrong with the data set in a folder, one sentence a fault; an empty list where nothing is.

    Rendering frames again and comparing them is not done here.
    """
    try:
        manifest = read_manifest(path)
    except DatasetError as error:
        return [str(error)]
    frame_faults = [fault for frame in _present(path, manifest) for fault in _frame_faults(path, manifest, frame)]
    missing = [frame for frame in manifest.selected if not frame_folder(path, frame).is_dir()]
    faults = [missing_sentence(path, missing, manifest.frame_count)] if missing else []
    faults += [*_strangers(path, manifest), *_asset_faults(path, manifest), *frame_faults]
    return faults + ([] if missing or frame_faults else list(_table_faults(path, manifest)))


def _present(path: Path, manifest: Manifest) -> list[int]:
    return [frame for frame in manifest.selected if frame_folder(path, frame).is_dir()]


def _frame_faults(path: Path, manifest: Manifest, frame: int) -> Iterator[str]:
    folder = frame_folder(path, frame)
    try:
        stated = read_frame_json(path, frame)["files"]
    except DatasetError as error:
        yield str(error)
        return
    there = {entry.name for entry in folder.iterdir()} - {FRAME_FILE}
    wanted = {name for camera in manifest.cameras for name in (image_name(camera), layers_name(camera))}
    wanted |= {name for lidar in manifest.lidars for name in (scan_name(lidar), beams_name(lidar))}
    for name in sorted(wanted - stated.keys()):
        yield f"{folder / name}: it is missing, also from {FRAME_FILE}"
    for name in sorted(there - stated.keys()):
        yield f"{folder / name}: it does not belong to the frame, {FRAME_FILE} does not name it"
    for name in sorted(stated):
        yield from _file_faults(folder / name, str(stated[name]))


def _file_faults(path: Path, stated: str) -> Iterator[str]:
    try:
        found = sha256_of_bytes(path.read_bytes())
    except OSError as error:
        yield f"{path}: it is missing or cannot be read ({error.strerror})"
        return
    if found != stated:
        yield f"{path}: its digest is {found}, {FRAME_FILE} states {stated}: it was truncated or edited"


def _strangers(path: Path, manifest: Manifest) -> Iterator[str]:
    """Whatever lies in the folder and is not of the data set."""
    frames = {frame_folder(path, frame).name for frame in manifest.selected}
    own = {path: {MANIFEST, TRUTH_TABLE, FRAMES, ASSETS}, path / FRAMES: frames}
    for folder, names in own.items():
        yield from (f"{stale}: a killed run left it half-written; --resume removes it" for stale in _leftovers(folder))
        for entry in _entries(folder):
            if entry.name not in names and not entry.name.startswith(TEMPORARY):
                yield f"{entry}: it does not belong to the data set"


def _entries(folder: Path) -> list[Path]:
    return sorted(folder.iterdir()) if folder.is_dir() else []


def _leftovers(folder: Path) -> Iterable[Path]:
    return leftovers(folder) if folder.is_dir() else []


def _asset_faults(path: Path, manifest: Manifest) -> Iterator[str]:
    named = mesh_paths(manifest.scenario)
    for name in named:
        try:
            found = asset_digest(path / name)
        except AssetError as error:
            yield str(error)
            continue
        if found != Path(name).stem:
            yield f"{path / name}: its digest is {found}, its name states {Path(name).stem}: it was truncated or edited"
    for entry in _entries(path / ASSETS):
        if f"{ASSETS}/{entry.name}" not in named:
            yield f"{entry}: it does not belong to the data set, no mesh of the scenario is called so"


def _table_faults(path: Path, manifest: Manifest) -> Iterator[str]:
    """The truth table against the frame.json files, value by value."""
    file = path / TRUTH_TABLE
    if not file.is_file():
        yield f"{file}: it is missing; --resume writes it"
        return
    try:
        table: list[dict[str, Any]] = Dataset(path, manifest).truth_table().to_dict("records")  # type: ignore[assignment]
    except DatasetError as error:
        yield str(error)
        return
    frames = list(rows(path, manifest.selected))
    if len(table) != len(frames):
        yield f"{file}: it has {len(table)} rows, the frames have {len(frames)}"
        return
    for in_table, in_frame in zip(table, frames, strict=True):
        for column in sorted({*in_table, *in_frame}):
            old, new = in_frame.get(column, math.nan), in_table.get(column)  # NaN: a column of other sensors' rows
            if not _same(old, new):
                where = f"frame {in_frame['frame']}, {in_frame['sensor']}, {column}"
                yield f"{file}: {where}: it states {new}, {FRAME_FILE} states {old}: it was edited"


def _same(one: Any, other: Any) -> bool:
    both_nan = isinstance(one, float) and isinstance(other, float) and math.isnan(one) and math.isnan(other)
    return both_nan or one == other
