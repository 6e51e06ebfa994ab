"""The only mesh reader, and how mesh files travel with a data set."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats, frozen
from scenes.errors import AssetError, nearest
from scenes.provenance import sha256_of_bytes
from scenes.winding import outward

FORMATS = (".glb", ".obj", ".ply", ".stl")  # each but OBJ states its size, so a truncated file is found out
LARGEST_BYTES = 512 * 2**20


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles: ``vertices_m`` (n, 3) metres, ``faces`` (m, 3) vertex indices, counter-clockwise seen from outside."""

    vertices_m: Floats
    faces: NDArray[np.int64]


def load_mesh(path: Path, scale: float = 1.0) -> Mesh:
    """The mesh of a file, its coordinates times ``scale`` being metres. The same file is read once.

    Closed bodies that are wound inside out are turned over, triangles without an area left out. Raises ``AssetError`` where
    the file is missing, broken, empty, has a NaN or an index out of range, or no triangle with an area.
    """
    mesh = _load(path, *_stamp(path))
    return mesh if scale == 1.0 else Mesh(frozen(mesh.vertices_m * scale), mesh.faces)


def check_mesh(path: Path) -> None:
    """Raises ``AssetError`` where ``load_mesh`` would."""
    _load(path, *_stamp(path))


def _stamp(path: Path) -> tuple[int, int]:
    """When the file was changed and its size: what makes a cached mesh out of date."""
    try:
        stamp = path.stat()
    except OSError as error:
        raise AssetError(f"{path}: cannot read the mesh: {error.strerror}") from None
    except ValueError as error:
        raise AssetError(f"{str(path)!r}: it is no path ({error})") from None
    if not path.is_file():
        raise AssetError(f"{path}: it is a directory or a device, not a mesh file")
    return stamp.st_mtime_ns, stamp.st_size


@lru_cache(maxsize=64)
def _load(path: Path, _changed_ns: int, size: int) -> Mesh:
    if path.suffix.lower() not in FORMATS:
        allowed = ", ".join(FORMATS)
        raise AssetError(f"{path}: {path.suffix!r} is no mesh format we read{nearest(path.suffix, FORMATS)} (there are: {allowed})")
    if size > LARGEST_BYTES:
        raise AssetError(f"{path}: the mesh file has {size / 2**20:.0f} MB, at most {LARGEST_BYTES // 2**20} MB are read")
    vertices, faces = _triangles(path)
    return _checked(path, vertices, faces)


def _triangles(path: Path) -> tuple[Floats, NDArray[np.int64]]:
    import trimesh

    data, kind = _bytes(path), path.suffix[1:].lower()
    if kind == "stl":
        _check_stl(path, data)
    try:
        # From bytes, so that no format can reach for other files (textures, buffers) by itself.
        mesh = trimesh.load(io.BytesIO(data), file_type=kind, force="mesh", process=False, skip_materials=True)
        return np.asarray(mesh.vertices, np.float64).reshape(-1, 3), np.asarray(mesh.faces, np.int64).reshape(-1, 3)
    except Exception as error:  # a parser of foreign files fails in any way there is
        why = "neither valid text nor valid binary" if isinstance(error, ImportError) else f"{type(error).__name__}: {error}"
        raise AssetError(f"{path}: the mesh cannot be read, the file is broken ({why})") from None


def _check_stl(path: Path, data: bytes) -> None:
    """A binary STL states its triangles: 80 bytes of header, their number, 50 bytes each."""
    count = int.from_bytes(data[80:84], "little")
    if len(data) != 84 + 50 * count and not data.lstrip().startswith(b"solid"):
        stated = f"a binary STL of {count} triangles has {84 + 50 * count} bytes"
        raise AssetError(f"{path}: the mesh file is truncated or no STL: {stated}, it has {len(data)}")


def _checked(path: Path, vertices: Floats, faces: NDArray[np.int64]) -> Mesh:
    if len(faces) == 0:
        raise AssetError(f"{path}: the mesh is empty or broken, it has {len(vertices)} vertices and no triangle")
    if not np.isfinite(vertices).all():
        bad = int(np.flatnonzero(~np.isfinite(vertices).all(axis=1))[0])
        raise AssetError(f"{path}: vertex {bad} of the mesh is {vertices[bad].tolist()}, not three finite numbers")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise AssetError(f"{path}: the mesh names vertex {faces.max()}, it has {len(vertices)}")
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    solid = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0
    if not solid.any():
        raise AssetError(f"{path}: none of the mesh's {len(faces)} triangles has an area")
    return Mesh(frozen(vertices), frozen(outward(vertices, faces)[solid], np.int64))


def map_mesh_paths(tree: Any, change: Callable[[str], str]) -> Any:
    """A plain tree with ``change`` applied to the ``path`` of every table with ``type = "mesh"``."""
    if isinstance(tree, Mapping):
        is_mesh = tree.get("type") == "mesh" and isinstance(tree.get("path"), str)
        changed = {name: map_mesh_paths(entry, change) for name, entry in tree.items()}
        return changed | {"path": change(tree["path"])} if is_mesh else changed
    return [map_mesh_paths(entry, change) for entry in tree] if isinstance(tree, list | tuple) else tree


def mesh_paths(tree: Any) -> list[str]:
    """The path of every table with ``type = "mesh"`` in a plain tree, sorted, each once."""
    found: set[str] = set()

    def note(path: str) -> str:
        found.add(path)
        return path

    map_mesh_paths(tree, note)
    return sorted(found)


def portable(scenario: Any) -> tuple[Any, dict[str, Path]]:
    """A scenario that does not depend on where its meshes lie, and name in the data set → file.

    Each mesh path becomes ``assets/<SHA-256, 32 digits>.<format>``: the scenario's digest follows the mesh's content.
    """
    files: dict[str, Path] = {}

    def name_of(path: str) -> str:
        name = f"assets/{asset_digest(Path(path))}{Path(path).suffix.lower()}"
        files[name] = Path(path)
        return name

    return map_mesh_paths(scenario, name_of), files


def with_assets_in(scenario: Any, folder: Path) -> Any:
    """The inverse of ``portable``: mesh paths point into the data set's ``folder`` again."""
    return map_mesh_paths(scenario, lambda path: str(folder / path))


def asset_digest(path: Path) -> str:
    """The first 32 hexadecimal digits of a file's SHA-256. Raises ``AssetError``."""
    return sha256_of_bytes(_bytes(path))[:32]


def asset_bytes(path: Path, digest: str) -> bytes:
    """The bytes of a file that had ``digest`` a moment ago. Raises ``AssetError`` where it was changed since."""
    data = _bytes(path)
    if sha256_of_bytes(data)[:32] != digest:
        raise AssetError(f"{path}: the mesh was changed while it was used: its digest was {digest}; start again")
    return data


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise AssetError(f"{path}: cannot read the mesh: {error.strerror}") from None
