"""Finding and opening TOML files: library entries by name, files by path, never outside the folder they belong to."""

import os
import tomllib
from importlib import resources
from pathlib import Path

from scenes.config_tree import Source, Table, tabled
from scenes.errors import ConfigError, unknown

LIBRARY = Path(str(resources.files("scenes").joinpath("library")))
KINDS = ("target", "material", "camera", "rig", "lidar", "light", "display", "scenario", "suite", "study", "paper")
_FOLDERS = {"study": "studies"}
LARGEST_BYTES = 4 * 2**20


def folder_of(kind: str) -> str:
    """The library folder of a kind, which may be given as the word or as the folder's name: scenario → scenarios."""
    folders = {name: _FOLDERS.get(name, f"{name}s") for name in KINDS}
    if kind not in folders and kind not in folders.values():
        raise ValueError(unknown("kind of library entry", kind, folders))
    return folders.get(kind, kind)


def is_path(text: str) -> bool:
    """Whether a reference is a path (it has a slash or ends in .toml) and not the name of a library entry."""
    return "/" in text or os.sep in text or text.endswith(".toml")


def library_names(folder: str, library: Path = LIBRARY) -> list[str]:
    """The names in a library folder, sorted."""
    return sorted(path.stem for path in (library / folder).glob("*.toml"))


def contained(path: Path, root: Path) -> Path:
    """``path`` with every symbolic link followed. Raises ``ConfigError`` where that leads out of ``root``."""
    real, real_root = path.resolve(), root.resolve()
    if not real.is_relative_to(real_root):
        raise ConfigError([f"{str(path)!r} leads to {real}, outside of {real_root}; name it on the command line to allow it"])
    return real


def locate(text: str, folder: str, asked_by: Source, library: Path = LIBRARY) -> tuple[Path, Source]:
    """The file that ``text`` names and what it will be as a source. Raises ``ConfigError`` with half a sentence."""
    if not is_path(text):
        names = library_names(folder, library)
        if text not in names:
            beside = asked_by.folder / f"{text}.toml"
            hint = f"; the file beside it is called './{text}.toml'" if _exists(beside) else ""
            raise ConfigError([unknown(f"entry of the library's {folder}", text, names) + hint])
        path = library / folder / f"{text}.toml"
        return path, Source(f"library/{folder}/{text}.toml", path.parent, library)
    path = asked_by.folder / text
    if asked_by.root is not None:
        contained(path, asked_by.root)
    label = os.path.normpath(path)
    return path, Source(label, path.parent, asked_by.root or path.parent)


def read_toml(path: Path, source: Source) -> Table:
    """The tables of a TOML file. Raises ``ConfigError`` with one sentence: missing, no file, too large, no UTF-8, no TOML."""
    try:
        return _parsed(_text(path), source)
    except OSError as error:
        reason = "there is no such file" if isinstance(error, FileNotFoundError) else f"cannot read it: {error.strerror}"
    except UnicodeDecodeError as error:
        reason = f"it is not UTF-8 text (byte {error.start} is 0x{error.object[error.start]:02x})"
    except RecursionError:
        reason = "it is nested too deeply to be TOML of ours"
    except ValueError as error:
        reason = f"it is not valid TOML: {_first_down(str(error))}"
    raise ConfigError([f"{source.label}: {reason}"])


def _text(path: Path) -> str:
    if path.is_dir():
        raise IsADirectoryError(None, "it is a directory, not a TOML file")
    if not path.exists():
        raise FileNotFoundError
    if not path.is_file():
        raise OSError(None, "it is a device or a pipe, not a TOML file")
    size = path.stat().st_size
    if size > LARGEST_BYTES:
        raise OSError(None, f"it has {size} bytes, a TOML file has at most {LARGEST_BYTES}")
    return path.read_bytes().decode("utf-8-sig")


def _parsed(text: str, source: Source) -> Table:
    table = tabled(tomllib.loads(text), source)
    assert isinstance(table, Table)
    return table


def _exists(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _first_down(text: str) -> str:
    return text[:1].lower() + text[1:]
