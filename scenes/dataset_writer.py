"""Writes a data set: each frame whole or not at all, by any number of processes, through kills and a full disk."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
from numpy.typing import NDArray

from scenes.assets import asset_bytes
from scenes.atomic import disk_errors, publish_file, publish_folder, sweep
from scenes.beam_truth import encode_beams
from scenes.dataset_frame import FrameRecord, frame_json
from scenes.dataset_layout import (
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
from scenes.dataset_manifest import Manifest, differences, read_manifest
from scenes.dataset_truth import truth_table_bytes
from scenes.errors import DatasetConflict, DatasetError
from scenes.exr import encode
from scenes.pcd import encode_scan
from scenes.provenance import sha256_of_bytes


@dataclass(frozen=True, slots=True)
class DatasetWriter:
    """The open folder of one data set. Several processes may each hold one for the same folder and write different frames."""

    path: Path
    manifest: Manifest

    @classmethod
    def open(cls, path: Path, manifest: Manifest, *, resume: bool = False) -> DatasetWriter:
        """Creates the folder, or with ``resume`` goes on with one of an equal manifest.

        Raises ``DatasetConflict`` where the folder holds another data set, an equal one without ``resume``, or anything
        else, and leaves it as it is; ``StorageError`` where the disk refuses.
        """
        with disk_errors(path):
            if (path / MANIFEST).exists():
                _check_same(path, manifest, resume)
            else:
                _check_empty(path)
                path.mkdir(parents=True, exist_ok=True)
                publish_file(path / MANIFEST, manifest.to_json().encode())
            (path / FRAMES).mkdir(exist_ok=True)
            for folder in (path, path / FRAMES):
                sweep(folder)
            writer = cls(path, manifest)
            writer._copy_assets()
        return writer

    def missing(self) -> list[int]:
        """The frames that are still to be written, ascending."""
        there = {entry.name for entry in (self.path / FRAMES).iterdir()}
        return [frame for frame in self.manifest.selected if frame_folder(self.path, frame).name not in there]

    def write(self, record: FrameRecord) -> None:
        """Publishes one frame; one that is there already is kept. Raises ``StorageError``, then nothing of it is there."""
        publish_folder(frame_folder(self.path, record.frame), frame_files(self.manifest, record))

    def finish(self) -> None:
        """Writes truth.parquet when all frames are there. Raises ``DatasetError`` naming the frames that are missing."""
        missing = self.missing()
        if missing:
            raise DatasetError(missing_sentence(self.path, missing, self.manifest.frame_count))
        publish_file(self.path / TRUTH_TABLE, truth_table_bytes(self.path, self.manifest))
        for folder in (self.path, self.path / FRAMES):
            sweep(folder, all_of_them=True)

    def _copy_assets(self) -> None:
        for name, source in sorted(self.manifest.assets.items()):
            target = self.path / name
            if not target.exists():
                target.parent.mkdir(exist_ok=True)
                publish_file(target, asset_bytes(source, target.stem))


def frame_files(manifest: Manifest, record: FrameRecord) -> dict[str, bytes]:
    """File name → bytes of one frame's folder: a function of manifest and record alone.

    Raises ``ValueError`` where the record is not of one of the manifest's frames or not of its sensors.
    """
    if record.frame not in manifest.selected:
        raise ValueError(f"frame {record.frame} is not one of {manifest.selected}")
    cameras, lidars = set(manifest.cameras), set(manifest.lidars)
    for given, wanted in (
        *((given, cameras) for given in (record.images, record.layers)),
        *((given, lidars) for given in (record.scans, record.scan_truth)),
        (record.truth, cameras | lidars),
    ):
        if given.keys() != wanted:
            raise ValueError(f"a frame has the sensors {sorted(given)}, the manifest {sorted(wanted)}")
    files = {image_name(camera): _png(pixels) for camera, pixels in sorted(record.images.items())}
    for camera, layers in sorted(record.layers.items()):
        entry = manifest.sensors[camera]
        size = int(str(entry["width_px"])), int(str(entry["height_px"]))
        files[layers_name(camera)] = encode(layers, *size, record.windows.get(camera))
    files |= {scan_name(lidar): encode_scan(scan) for lidar, scan in sorted(record.scans.items())}
    files |= {beams_name(lidar): encode_beams(arrays) for lidar, arrays in sorted(record.scan_truth.items())}
    digests = {name: sha256_of_bytes(data) for name, data in files.items()}
    return {**files, FRAME_FILE: frame_json(record, digests).encode()}


def missing_sentence(path: Path, missing: list[int], total: int) -> str:
    """Which frames are not there and what to do about it."""
    shown = ", ".join(f"{frame:06d}" for frame in missing[:8]) + (", ..." if len(missing) > 8 else "")
    return f"{path}: {len(missing)} of {total} frames are missing ({shown}); render them with --resume"


def _check_same(path: Path, manifest: Manifest, resume: bool) -> None:
    there = read_manifest(path)
    points = differences(there, manifest)
    if points:
        raise DatasetConflict(f"{path}: it holds another data set and is left as it is; {'; '.join(points)}")
    if not resume:
        raise DatasetConflict(f"{path}: it holds this data set already; go on with --resume or choose another folder")


def _check_empty(path: Path) -> None:
    if path.exists() and not path.is_dir():
        raise DatasetConflict(f"{path}: it is a file, not a folder; choose another name")
    others = [entry.name for entry in sorted(path.iterdir()) if not entry.name.startswith(TEMPORARY)] if path.exists() else []
    if others:
        raise DatasetConflict(f"{path}: it is no data set and not empty (it has {others[0]!r}); choose another folder")


def _png(pixels: NDArray[Any]) -> bytes:
    if pixels.ndim != 2 or pixels.dtype.name not in {"uint8", "uint16"}:
        raise ValueError(f"a picture is (height, width) of uint8 or uint16, got {pixels.shape} of {pixels.dtype}")
    done, data = cv2.imencode(".png", pixels)
    if not done:
        raise ValueError(f"OpenCV could not encode a picture of {pixels.shape} as PNG")
    return bytes(data.tobytes())
