"""What is known of a method without importing it: one line of description, its distribution's version, typed parameters."""

import ast
from collections.abc import Sequence
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path

import estimators
import scenes
from estimators.registry import GROUP
from scenes.errors import UsageError
from scenes.provenance import sha256_of_bytes, sha256_of_json


def description(name: str) -> str:
    """The first line of the docstring of the module that holds the method, read from its source; else where it lies."""
    entry = _entry(name)
    if entry is None:
        return ""
    try:
        spec = find_spec(entry.module)
        source = Path(spec.origin).read_text(encoding="utf-8") if spec and spec.origin else ""
        first = (ast.get_docstring(ast.parse(source)) or "").splitlines()[:1]
    except (ImportError, OSError, SyntaxError, ValueError):
        first = []
    return first[0].removeprefix(f"``{name}``: ") if first else entry.value


def version(name: str) -> str:
    """The version of the distribution that brought the method, empty for one named by ``package.module:Class``."""
    entry = _entry(name)
    return entry.dist.version if entry is not None and entry.dist is not None else ""


def source_digest(name: str) -> str:
    """SHA-256 of the sources that a method's answers depend on: its package's, and what all methods share.

    Of one named by ``package.module:Class`` the folder that its module lies in. Empty where no source is found.
    """
    entry = _entry(name)
    module = entry.module if entry is not None else name.partition(":")[0]
    folders = [_folder_of(module), *(Path(package.__path__[0]) for package in (estimators, scenes))]
    here, *shared = folders
    if here is None:
        return ""
    files = {*here.rglob("*.py"), *(path for folder in shared if folder is not None for path in folder.glob("*.py"))}
    return sha256_of_json({str(path.relative_to(path.parents[1])): sha256_of_bytes(path.read_bytes()) for path in sorted(files)})


def parameters_of(overrides: Sequence[str]) -> dict[str, object]:
    """A method's parameters as they were typed, ``name=value`` or ``group.name=value`` each.

    Raises ``UsageError`` for what is not of that form, and for a name that is a value and a group at once.
    """
    from scenes.config import parse_override

    parameters: dict[str, object] = {}
    for text in overrides:
        (*groups, name), value = parse_override(text)
        group = parameters
        for key in groups:
            inner = group.setdefault(str(key), {})
            if not isinstance(inner, dict):
                raise UsageError(f"--set {text!r}: {key!r} was given a value of its own before")
            group = inner
        group[str(name)] = value
    return parameters


def _folder_of(module: str) -> Path | None:
    try:
        spec = find_spec(module)
    except (ImportError, ValueError):
        return None
    return Path(spec.origin).parent if spec is not None and spec.origin else None


def _entry(name: str) -> EntryPoint | None:
    return next((entry for entry in entry_points(group=GROUP) if entry.name == name), None)
