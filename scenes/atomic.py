"""Files and folders that exist whole or not at all: written beside, fsync'ed, renamed, parent fsync'ed (POSIX)."""

import errno
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from scenes.dataset_layout import TEMPORARY
from scenes.errors import StorageError

_FULL = {errno.ENOSPC, errno.EDQUOT}
_TAKEN = {errno.EEXIST, errno.ENOTEMPTY}


def publish_file(path: Path, data: bytes) -> None:
    """Puts ``data`` at ``path`` in one step, over what may be there. Raises ``StorageError``, leaving no trace of itself."""
    temporary = _temporary(path)
    with _cleaned_up(temporary, path):
        _write(temporary, data)
        temporary.replace(path)
        _sync_folder(path.parent)


def publish_folder(path: Path, files: Mapping[str, bytes]) -> None:
    """Puts a folder with ``files`` (name → bytes) at ``path`` in one step; a folder that is there already is kept.

    Whoever publishes the same folder at the same time writes the same bytes, so the first one wins. Raises ``StorageError``.
    """
    temporary = _temporary(path)
    with _cleaned_up(temporary, path):
        temporary.mkdir()
        for name, data in files.items():
            _write(temporary / name, data)
        _sync_folder(temporary)
        _rename_unless_there(temporary, path)
        _sync_folder(path.parent)


def sweep(folder: Path, *, all_of_them: bool = False) -> None:
    """Removes what killed runs left half-written in ``folder``: only of processes that are gone, unless ``all_of_them``."""
    for path in leftovers(folder):
        if all_of_them or not _is_alive(path):
            _remove(path)


def leftovers(folder: Path) -> list[Path]:
    """What is half-written in ``folder``, by running processes or by killed ones."""
    return sorted(folder.glob(f"{TEMPORARY}*"))


@contextmanager
def disk_errors(path: Path) -> Iterator[None]:
    """Turns what the operating system says about ``path`` into a ``StorageError`` with one clear sentence."""
    try:
        yield
    except OSError as error:
        if error.errno in _FULL:
            text = f"the disk is full: {path} was not written; free some space and go on with --resume, nothing is lost"
        else:
            text = f"cannot write {path}: {error.strerror or error}"
        raise StorageError(text) from error


@contextmanager
def _cleaned_up(temporary: Path, path: Path) -> Iterator[None]:
    try:
        with disk_errors(path):
            _remove(temporary)  # a killed process of the same number may have left it
            yield
    finally:
        _remove(temporary)


def _temporary(path: Path) -> Path:
    return path.parent / f"{TEMPORARY}{os.getpid()}-{path.name}"


def _write(path: Path, data: bytes) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _sync_folder(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _rename_unless_there(source: Path, path: Path) -> None:
    try:
        source.rename(path)
    except OSError as error:
        if error.errno not in _TAKEN:
            raise


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _is_alive(path: Path) -> bool:
    number = path.name.removeprefix(TEMPORARY).partition("-")[0]
    if not number.isdecimal():
        return False
    try:
        os.kill(int(number), 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return True
