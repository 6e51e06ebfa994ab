"""The only data set reader: what an estimator may see and what only the judge may, each checked against its digest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter

from scenes.assets import with_assets_in
from scenes.beam_truth import decode_beams
from scenes.dataset_frame import read_frame_json, truth_of
from scenes.dataset_layout import FRAME_FILE, TRUTH_TABLE, beams_name, frame_folder, image_name, layers_name, scan_name
from scenes.dataset_lidar import chaser_state, lidar_model
from scenes.dataset_manifest import Manifest, read_manifest, sensor_model, stereo_pairs
from scenes.dataset_writer import missing_sentence
from scenes.errors import DatasetError
from scenes.exr import decode
from scenes.features import Feature
from scenes.pcd import decode_scan
from scenes.provenance import sha256_of_bytes
from scenes.recording import Image, LidarModel, Observation, Scan, SensorModel, StereoPair, Truth

if TYPE_CHECKING:
    import pandas as pd

_FEATURES: TypeAdapter[tuple[Feature, ...]] = TypeAdapter(tuple[Feature, ...])


@dataclass(frozen=True)
class Dataset:
    """A complete data set in a folder."""

    path: Path
    manifest: Manifest

    @classmethod
    def open(cls, path: Path) -> Dataset:
        """Opens a data set whose frames are all there. Raises ``DatasetError`` saying what is missing or broken."""
        manifest = read_manifest(path)
        missing = [frame for frame in manifest.selected if not frame_folder(path, frame).is_dir()]
        if missing:
            raise DatasetError(missing_sentence(path, missing, manifest.frame_count))
        if not (path / TRUTH_TABLE).is_file():
            raise DatasetError(f"{path}: {TRUTH_TABLE} is missing; write it with --resume")
        return cls(path, manifest)

    @property
    def frames(self) -> list[int]:
        """The frame numbers, ascending."""
        return list(self.manifest.selected)

    @property
    def identity(self) -> str:
        """The digest that predictions are tied to."""
        return self.manifest.identity

    @property
    def scenario(self) -> dict[str, Any]:
        """The resolved scenario, its mesh paths pointing into this folder: enough to render any frame again."""
        return dict(with_assets_in(self.manifest.scenario, self.path))

    @cached_property
    def sensors(self) -> Mapping[str, SensorModel]:
        """Camera → calibration."""
        where = self.path / "manifest.json"
        models = {name: sensor_model(entry, f"{where}: sensors.{name}") for name, entry in self.manifest.cameras.items()}
        return MappingProxyType(models)

    @cached_property
    def lidars(self) -> Mapping[str, LidarModel]:
        """LIDAR → calibration."""
        where = self.path / "manifest.json"
        models = {name: lidar_model(entry, f"{where}: sensors.{name}") for name, entry in self.manifest.lidars.items()}
        return MappingProxyType(models)

    @cached_property
    def features(self) -> tuple[Feature, ...]:
        """The target's named features."""
        target = self.manifest.scenario.get("target")
        features = target.get("features", []) if isinstance(target, dict) else []
        return _FEATURES.validate_python(features or [], strict=False)

    @cached_property
    def rigs(self) -> Mapping[str, StereoPair]:
        """Stereo rig → its calibrated pair of cameras."""
        return MappingProxyType(stereo_pairs(self.manifest.sensors))

    def observation(self, frame: int) -> Observation:
        """What the chaser has at one frame. Raises ``DatasetError`` on a missing, truncated or edited file."""
        body = self._body(frame)
        images = {name: Image(self._image(frame, name, body)) for name in self.manifest.cameras}
        scans = {name: self._scan(frame, name, body) for name in self.manifest.lidars}
        chaser = chaser_state(body["state"], f"{frame_folder(self.path, frame) / FRAME_FILE}")
        return Observation(frame, float(body["time_s"]), MappingProxyType(images), MappingProxyType(scans), chaser)

    def truth(self, frame: int) -> Truth:
        """What only the judge has."""
        return truth_of(self._body(frame))

    def state(self, frame: int) -> dict[str, Any]:
        """What else the renderer recorded of a frame: motion state, light, exposure."""
        return dict(self._body(frame)["state"])

    def truth_table(self) -> pd.DataFrame:
        """truth.parquet: one row per (frame, sensor)."""
        import pandas as pd

        try:
            return pd.read_parquet(self.path / TRUTH_TABLE)
        except (OSError, ValueError) as error:
            raise DatasetError(f"{self.path / TRUTH_TABLE}: it is truncated or edited ({error})") from None

    def layers(self, frame: int, camera: str) -> dict[str, NDArray[Any]]:
        """Layer name → (height, width), float32 or uint32."""
        name = layers_name(camera)
        data = self._file(frame, name, self._body(frame))
        try:
            return decode(data)
        except ValueError as error:
            raise DatasetError(f"{frame_folder(self.path, frame) / name}: {error}") from None

    def scan_truth(self, frame: int, lidar: str) -> dict[str, NDArray[Any]]:
        """What only the judge has of each beam: name → (rows, columns) or (rows, columns, 3)."""
        name = beams_name(lidar)
        data = self._file(frame, name, self._body(frame))
        try:
            return decode_beams(data)
        except ValueError as error:
            raise DatasetError(f"{frame_folder(self.path, frame) / name}: {error}") from None

    def image_path(self, frame: int, camera: str) -> Path:
        """The PNG of one frame and camera."""
        return frame_folder(self.path, frame) / image_name(camera)

    def _body(self, frame: int) -> dict[str, Any]:
        if frame not in self.manifest.selected:
            raise DatasetError(f"{self.path}: it has no frame {frame}, only {self.manifest.selected}")
        return read_frame_json(self.path, frame)

    def _image(self, frame: int, camera: str, body: Mapping[str, Any]) -> NDArray[Any]:
        data = self._file(frame, image_name(camera), body)
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
        size = self.sensors[camera].intrinsics
        if pixels is None or pixels.shape != (size.height_px, size.width_px):
            shape = None if pixels is None else pixels.shape
            raise DatasetError(f"{self.image_path(frame, camera)}: its shape is {shape}, not {(size.height_px, size.width_px)}")
        pixels.flags.writeable = False
        return np.asarray(pixels)

    def _scan(self, frame: int, lidar: str, body: Mapping[str, Any]) -> Scan:
        name, model = scan_name(lidar), self.lidars[lidar]
        where = frame_folder(self.path, frame) / name
        try:
            scan = decode_scan(self._file(frame, name, body))
        except ValueError as error:
            raise DatasetError(f"{where}: {error}") from None
        if scan.intensity.shape != (model.rows, model.columns):
            raise DatasetError(f"{where}: its shape is {scan.intensity.shape}, not {(model.rows, model.columns)}")
        return scan

    def _file(self, frame: int, name: str, body: Mapping[str, Any]) -> bytes:
        path = frame_folder(self.path, frame) / name
        try:
            data = path.read_bytes()
        except OSError as error:
            raise DatasetError(f"{path}: cannot read it: {error.strerror}") from None
        stated, found = body["files"].get(name), sha256_of_bytes(data)
        if stated != found:
            raise DatasetError(f"{path}: its digest is {found}, frame.json states {stated}: it was truncated or edited")
        return data
