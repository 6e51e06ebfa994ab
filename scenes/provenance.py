"""Where a result comes from: canonical text, digests, random streams and the versions of the software that made it."""

import hashlib
import json
import platform
import zlib
from collections.abc import Mapping
from importlib import metadata
from typing import Any

import numpy as np

# Distributions whose version can change a byte of a data set: arithmetic, triangulation, ray tracing, encoders.
_DISTRIBUTIONS = {
    "hardlight": "hardlight",
    "numpy": "numpy",
    "scipy": "scipy",
    "trimesh": "trimesh",
    "mitsuba": "mitsuba",
    "drjit": "drjit",
    "pyoidn": "pyoidn",
    "opencv": "opencv-python-headless",
    "OpenEXR": "OpenEXR",
    "pypcd4": "pypcd4",
    "pyarrow": "pyarrow",
}


def canonical_json(value: Any) -> str:
    """``value`` as the one JSON text that stands for it: sorted keys, no white space, shortest round-trip floats.

    Mappings, sequences, numpy numbers and arrays are allowed. Raises ``ValueError`` on NaN and infinity, which JSON does not
    have, and ``TypeError`` on anything without a plain form.
    """
    return json.dumps(_plain(value), sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


def readable_json(value: Any) -> str:
    """The canonical JSON spread over lines, for files that people open: one text for one value, too."""
    return json.dumps(_plain(value), sort_keys=True, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {_key(name): _plain(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    return value


def _key(name: Any) -> str:
    if not isinstance(name, str):
        raise TypeError(f"a JSON key is a string, got {name!r}")
    return name


def sha256_of_bytes(data: bytes) -> str:
    """SHA-256 as 64 hexadecimal digits."""
    return hashlib.sha256(data).hexdigest()


def sha256_of_json(value: Any) -> str:
    """SHA-256 of the canonical JSON of ``value`` (UTF-8)."""
    return sha256_of_bytes(canonical_json(value).encode())


def stream(seed: int, frame: int, path: str) -> np.random.Generator:
    """The random stream of one field of one frame: PCG64 seeded with (seed, spawn key = (frame, CRC-32 of ``path``)).

    Streams are independent (numpy's SeedSequence), so any frame is drawn alone and a new field changes no other.
    ``seed`` and ``frame`` are whole numbers ≥ 0.
    """
    sequence = np.random.SeedSequence(seed, spawn_key=(frame, zlib.crc32(path.encode())))
    return np.random.Generator(np.random.PCG64(sequence))


def software_versions() -> dict[str, str]:
    """Version of everything that can change a byte of a data set; ``"absent"`` for what is not installed."""
    return {"python": platform.python_version()} | {name: _version(dist) for name, dist in _DISTRIBUTIONS.items()}


def _version(distribution: str) -> str:
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return "absent"
