"""Writing results: a set of files appears whole or not at all, and a full disk is one sentence."""

import os
from collections.abc import Mapping
from pathlib import Path

from scenes.errors import StorageError


def publish(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Writes ``contents`` (file name → bytes) into ``folder``: all beside their final names first, then renamed in order.

    Raises ``StorageError`` where writing fails; what stood in the folder before is then untouched.
    """
    beside = {name: folder / f".{name}.partial-{os.getpid()}" for name in contents}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, data in contents.items():
            _write_through(beside[name], data)
        for name, path in beside.items():
            path.replace(folder / name)
    except OSError as error:
        raise StorageError(f"cannot write to {folder}: {error.strerror or error}") from error
    finally:
        for path in beside.values():
            path.unlink(missing_ok=True) if folder.is_dir() else None


def _write_through(path: Path, data: bytes) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
