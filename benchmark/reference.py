"""A reference: the small part of results that is kept, with a manifest.json that says what made it and accounts for it."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

from pydantic import ValidationError

from benchmark.errors import PredictionsError, damaged
from benchmark.records import MachineRecord
from scenes.dataset_layout import FRAME_FILE
from scenes.dataset_layout import FRAMES as FRAMES_FOLDER
from scenes.provenance import sha256_of_bytes
from scenes.spec import Spec

MANIFEST, FRAMES = "manifest.json", "frames.json"


class ReferenceDataset(Spec):
    """A data set that is not kept: its identity and how many frames it has, whose digests are in its ``frames.json``."""

    identity: str
    frames: int


class Reference(Spec):
    """manifest.json of a reference. Paths are relative to it.

    ``command``: what makes the results anew, empty where the suite is not of the library. ``software``: of the program that kept
    them; ``machines``: where the answers were computed. ``files``: every other file → its SHA-256.
    """

    format: Literal["hardlight-reference"] = "hardlight-reference"
    version: Literal[1] = 1
    title: str
    command: str = ""
    software: dict[str, str]
    machines: tuple[MachineRecord, ...] = ()
    datasets: dict[str, ReferenceDataset]
    files: dict[str, str]


def read(folder: Path) -> Reference | None:
    """The manifest of a reference; None where a folder of results has none. Raises ``PredictionsError`` on a damaged one."""
    path = folder / MANIFEST
    if not path.is_file():
        return None
    try:
        return Reference.model_validate_json(path.read_bytes())
    except ValidationError as error:
        raise damaged(path, error) from error


def faults(folder: Path, reference: Reference) -> Iterator[str]:
    """Every file that is not what the manifest says, one sentence a fault."""
    there = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if not path.is_dir()}
    there.pop(MANIFEST, None)
    yield from (f"{name}: it is missing" for name in sorted(reference.files.keys() - there.keys()))
    for name, path in there.items():
        if name not in reference.files:
            yield f"{name}: it does not belong to the reference, {MANIFEST} does not name it"
        elif (found := sha256_of_bytes(path.read_bytes())) != reference.files[name]:
            yield f"{name}: its digest is {found}, {MANIFEST} states {reference.files[name]}: it was truncated or edited"


def frame_digests(dataset: Path) -> dict[str, str] | None:
    """Frame → SHA-256 of its frame.json, which states the digest of each of its files; None where neither frames nor digests are.

    The same for a data set and for what a reference keeps of it.
    """
    kept, frames = dataset / FRAMES, dataset / FRAMES_FOLDER
    if frames.is_dir():
        folders = sorted(path for path in frames.iterdir() if path.name.isdecimal())
        return {str(int(path.name)): sha256_of_bytes((path / FRAME_FILE).read_bytes()) for path in folders}
    if not kept.is_file():
        return None
    return _digests(kept)


def _digests(path: Path) -> dict[str, str]:
    try:
        stated: Any = json.loads(path.read_bytes())
    except ValueError as error:
        raise PredictionsError(f"{path} is damaged: {error}") from error
    if not isinstance(stated, dict):
        raise PredictionsError(f"{path} is damaged: it is not a table of digests")
    return {str(frame): str(digest) for frame, digest in stated.items()}
