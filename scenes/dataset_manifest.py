"""What a data set says of itself: the scenario that made it, the seed, the frames, the sensors, the software."""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, JsonValue, PrivateAttr, ValidationError, model_validator

from scenes.assets import mesh_paths, portable
from scenes.dataset_layout import FORMAT, MANIFEST, VERSION
from scenes.dataset_lidar import is_lidar
from scenes.errors import DatasetError
from scenes.intrinsics import Intrinsics
from scenes.pose_columns import pose, pose_columns
from scenes.provenance import canonical_json, readable_json, sha256_of_json, software_versions
from scenes.recording import SensorModel, StereoPair
from scenes.rig import StereoRig
from scenes.spec import Spec

SensorName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$")]  # it becomes a file name
Table = dict[str, JsonValue]
_ASSET = re.compile(r"assets/[0-9a-f]{32}\.[a-z]{3}")
_SHOWN = 4  # of the key paths in which two scenarios differ


class Manifest(Spec):
    """The identity of a data set. Two runs with equal manifests write equal bytes.

    ``scenario``: resolved, plain. ``frames`` = (start, stop, step) of the selected frame numbers. ``sensors``: name →
    calibration (see ``calibration``) and whatever else the renderer says of it. ``backend``: what computed the pictures.
    """

    format: Literal["hardlight-dataset"] = FORMAT
    version: Literal[1] = VERSION
    scenario: Table
    seed: Annotated[int, Field(ge=0)]
    frames: tuple[int, int, int]
    frame_count: Annotated[int, Field(ge=1)]
    sensors: dict[SensorName, Table]
    software: dict[str, str]
    backend: Table
    quality: JsonValue
    _assets: dict[str, Path] = PrivateAttr(default_factory=dict)

    @classmethod
    def of(
        cls,
        *,
        scenario: Mapping[str, Any],
        seed: int,
        frames: range,
        sensors: Mapping[str, Mapping[str, Any]],
        backend: Mapping[str, Any],
        quality: Any,
        software: Mapping[str, str] | None = None,
    ) -> "Manifest":
        """The manifest of a run. Mesh files that the scenario names will travel with the data set."""
        plain, assets = portable(_plain(scenario))
        manifest = cls(
            scenario=plain,
            seed=seed,
            frames=(frames.start, frames.stop, frames.step),
            frame_count=len(frames),
            sensors=_plain(sensors),
            software=dict(software_versions() if software is None else software),
            backend=_plain(backend),
            quality=_plain(quality),
        )
        manifest._assets.update(assets)
        return manifest

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        if self.frames[2] < 1 or len(self.selected) != self.frame_count:
            raise ValueError(f"frames {self.frames} are not {self.frame_count} frames")
        for path in mesh_paths(self.scenario):
            if not _ASSET.fullmatch(path):
                raise ValueError(f"the mesh {path!r} does not lie in the data set")
        return self

    @property
    def selected(self) -> range:
        """The frame numbers, ascending."""
        return range(*self.frames)

    @property
    def cameras(self) -> dict[str, Table]:
        """The entries of ``sensors`` that are cameras."""
        return {name: entry for name, entry in self.sensors.items() if not is_lidar(entry)}

    @property
    def lidars(self) -> dict[str, Table]:
        """The entries of ``sensors`` that are LIDARs."""
        return {name: entry for name, entry in self.sensors.items() if is_lidar(entry)}

    @property
    def digest(self) -> str:
        """SHA-256 of the canonical JSON of the resolved scenario."""
        return sha256_of_json(self.scenario)

    @property
    def identity(self) -> str:
        """SHA-256 over everything that decides the bytes of the data set; predictions are tied to it."""
        return sha256_of_json(self.model_dump())

    @property
    def assets(self) -> dict[str, Path]:
        """Name in the data set → the mesh file that a new data set copies there (empty for one that was read)."""
        return dict(self._assets)

    def to_json(self) -> str:
        """The text of manifest.json, with ``digest`` and ``identity`` in it."""
        return readable_json(self.model_dump() | {"digest": self.digest, "identity": self.identity})


def read_manifest(dataset: Path) -> Manifest:
    """The manifest of the data set in a folder. Raises ``DatasetError`` where there is none, or a broken or edited one."""
    path = dataset / MANIFEST
    raw = _read(path)
    if raw.get("format") != FORMAT or raw.get("version") != VERSION:
        found = f"{raw.get('format')!r} version {raw.get('version')!r}"
        raise DatasetError(f"{path}: it is {found}, this program reads {FORMAT!r} version {VERSION}")
    stated = {name: raw.pop(name, None) for name in ("digest", "identity")}
    try:
        manifest = Manifest.model_validate_json(json.dumps(raw), strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(str(key) for key in first["loc"]) or "the manifest"
        raise DatasetError(f"{path}: {where}: {first['msg']} (got {first['input']!r:.80})") from None
    for name, text in stated.items():
        if text != getattr(manifest, name):
            raise DatasetError(f"{path}: it states {name} {text}, its content has {getattr(manifest, name)}: it was edited")
    return manifest


def differences(there: Manifest, here: Manifest) -> list[str]:
    """In which points two manifests differ, one text a point, with both values: ``seed: 1 in the folder, 2 asked for``."""
    points = [("digest", there.digest, here.digest), *_deep("scenario", there.scenario, here.scenario)[:_SHOWN]]
    points += [(name, getattr(there, name), getattr(here, name)) for name in ("seed", "frames", "quality")]
    for name in ("sensors", "backend", "software"):
        points += _deep(name, getattr(there, name), getattr(here, name))
    return [f"{name}: {_short(old)} in the folder, {_short(new)} asked for" for name, old, new in points if old != new]


def calibration(model: SensorModel, **more: Any) -> dict[str, Any]:
    """A camera's entry of ``Manifest.sensors``; ``more`` is kept beside it (bits, mount, ...)."""
    intrinsics = {name: getattr(model.intrinsics, name) for name in Intrinsics.__dataclass_fields__}
    return dict(_plain({**more, **intrinsics, "black_dn": model.black_dn, "white_dn": model.white_dn}))


def sensor_model(entry: Mapping[str, Any], where: str) -> SensorModel:
    """The calibration back from an entry of ``Manifest.sensors``. Raises ``DatasetError`` naming ``where``."""
    try:
        numbers = {name: entry[name] for name in Intrinsics.__dataclass_fields__}
        numbers["distortion"] = tuple(float(value) for value in numbers["distortion"])
        return SensorModel(Intrinsics(**numbers), float(entry["black_dn"]), float(entry["white_dn"]))
    except (KeyError, TypeError, ValueError) as error:
        raise DatasetError(f"{where}: it is no camera calibration ({error!r})") from None


def rig_entry(rig: StereoRig, name: str, sensor: str) -> dict[str, Any]:
    """What a camera's entry of ``Manifest.sensors`` says of its rig: the pair, ``right_from_left`` and F of ideal pixels."""
    left, right = rig.sensors(name)
    return {
        "name": name,
        "left": left,
        "right": right,
        "is_left": sensor == left,
        "baseline_m": rig.baseline_m,
        "toe_in_deg": rig.toe_in_deg,
        "right_from_left": pose_columns(rig.right_from_left),
        "fundamental_matrix": rig.fundamental_matrix.tolist(),
    }


def stereo_pairs(sensors: Mapping[str, Mapping[str, Any]], where: str = "manifest.json") -> dict[str, StereoPair]:
    """Rig → pair, back from the entries of ``Manifest.sensors``. Raises ``DatasetError`` naming ``where``."""
    entries = {name: entry["rig"] for name, entry in sensors.items() if "rig" in entry}
    try:
        return {
            str(rig["name"]): StereoPair(str(rig["left"]), str(rig["right"]), pose(rig["right_from_left"]))
            for rig in entries.values()
            if {rig["left"], rig["right"]} <= sensors.keys()
        }
    except (KeyError, TypeError, ValueError) as error:
        raise DatasetError(f"{where}: it holds no stereo calibration ({error!r})") from None


def _plain(value: Any) -> Any:
    return json.loads(canonical_json(value))


def _read(path: Path) -> dict[str, Any]:
    try:
        raw = json.loads(path.read_bytes())
    except FileNotFoundError:
        raise DatasetError(f"{path.parent}: it is no data set, {MANIFEST} is missing") from None
    except OSError as error:
        raise DatasetError(f"{path}: cannot read it: {error.strerror}") from None
    except ValueError as error:
        raise DatasetError(f"{path}: it is truncated or edited, not JSON ({error})") from None
    if not isinstance(raw, dict):
        raise DatasetError(f"{path}: it is truncated or edited, not a table")
    return raw


def _deep(path: str, there: Any, here: Any) -> list[tuple[str, Any, Any]]:
    """The key paths at which two plain trees differ, with both values."""
    if isinstance(there, dict) and isinstance(here, dict):
        keys = sorted({*there, *here})
        return [point for key in keys for point in _deep(f"{path}.{key}", there.get(key), here.get(key))]
    if isinstance(there, list) and isinstance(here, list) and len(there) == len(here):
        return [point for i, pair in enumerate(zip(there, here)) for point in _deep(f"{path}.{i}", *pair)]
    return [] if there == here else [(path, there, here)]


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else canonical_json(value)
    return text if len(text) <= 80 else text[:77] + "..."
