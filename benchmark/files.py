"""Files of results: a set of them appears whole or not at all, a full disk and a damaged record are one sentence."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from benchmark.errors import PredictionsError, damaged
from scenes.errors import StorageError

Record = TypeVar("Record", bound=BaseModel)


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


def read_record(folder: Path, name: str, model: type[Record], remedy: str) -> Record:
    """The JSON file ``name`` of ``folder`` as a ``model``; ``remedy``: what to do where there is none.

    Raises ``PredictionsError`` where there is none or it is damaged.
    """
    path = folder / name
    try:
        return model.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        raise PredictionsError(f"{folder} holds no {name}; {remedy}") from None
    except ValidationError as error:
        raise damaged(path, error) from error


def _write_through(path: Path, data: bytes) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
