"""What is known of a method without importing it: one line of description, its distribution's version, typed parameters."""

import ast
from collections.abc import Sequence
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path

from estimators.registry import GROUP
from scenes.errors import UsageError


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


def parameters_of(overrides: Sequence[str]) -> dict[str, object]:
    """A method's parameters as they were typed, ``name=value`` each. Raises ``UsageError`` for what is not of that form."""
    from scenes.config import parse_override

    parameters: dict[str, object] = {}
    for text in overrides:
        keys, value = parse_override(text)
        if len(keys) != 1:
            raise UsageError(f"--set {text!r}: a method's parameter has one name without dots")
        parameters[keys[0]] = value
    return parameters


def _entry(name: str) -> EntryPoint | None:
    return next((entry for entry in entry_points(group=GROUP) if entry.name == name), None)
