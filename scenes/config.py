"""The only TOML reader: a library name or a path in, a validated model out, every fault at once."""

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from scenes.config_faults import sentences
from scenes.config_files import LIBRARY, folder_of, library_names, locate, read_toml
from scenes.config_references import BASE, Resolver
from scenes.config_tree import Source, Table, assigned
from scenes.errors import ConfigError, UsageError

Model = TypeVar("Model", bound=BaseModel)
_SET = "--set"  # as the source of keys


def load(
    kind: str,
    name_or_path: str,
    model: type[Model],
    overrides: Sequence[str] = (),
    *,
    references: Mapping[str, str] | None = None,
    library: Path = LIBRARY,
) -> Model:
    """The entry ``name_or_path`` of a kind (scenario, target, camera, ...) as a ``model``.

    A text with a slash or ending in ``.toml`` is a path, any other a library name. ``references``: patterns of key paths
    (``*`` = any one key) → kind; there a string names a library entry or a file relative to the file that it stands in, and
    a table with ``base`` is that entry with the other keys laid over it. ``overrides``: ``key.path=value`` in turn, the
    value as in TOML, a bare word being a string. Values are read strictly: a number in quotes is a string.

    Raises ``ConfigError`` with one sentence for every fault.
    """
    on_command_line = Source("the command line", Path(), None)
    file, source = locate(name_or_path, folder_of(kind), on_command_line, library)
    resolver = Resolver({**(references or {}), "": kind}, library)
    tree = resolver.resolve(read_toml(file, source), source, trail=(file.resolve(),))
    tree, faults = _overridden(tree, overrides, resolver)
    return _validated(tree, model, [*resolver.faults, *faults], resolver)


def list_library(kind: str, library: Path = LIBRARY) -> dict[str, str]:
    """Name → what it is (its ``description``, else its first comment line), of all entries of a kind; nothing is validated."""
    folder = library / folder_of(kind)
    return {name: _summary(folder / f"{name}.toml") for name in library_names(folder_of(kind), library)}


def parse_override(text: str) -> tuple[list[str], Any]:
    """Key path and value of ``key.path=value``. Raises ``UsageError``."""
    path, equals, value = text.partition("=")
    keys = [key.strip() for key in path.split(".")]
    if not equals or not all(keys):
        raise UsageError(f"--set {text!r} is not of the form key.path=value")
    if not value.strip():
        raise UsageError(f"--set {text!r} gives no value; write {path}='\"\"' for an empty string")
    try:
        parsed = tomllib.loads(f"value = {value}")
    except (ValueError, RecursionError):
        parsed = {}
    return keys, parsed["value"] if parsed.keys() == {"value"} else value.strip()


def _overridden(tree: Table, overrides: Iterable[str], resolver: Resolver) -> tuple[Table, list[str]]:
    """The tree with the overrides in it, each seeing what the ones before it named, and what was wrong with them."""
    faults = []
    for text in overrides:
        try:
            keys, value = parse_override(text)
            _refuse_late_base(tree, keys, value)
            tree = resolver.resolve(assigned(tree, keys, value, Source(_SET, Path(), None)), tree.origin)
        except UsageError as error:
            faults.append(str(error) if str(error).startswith("--set") else f"--set {text!r}: {error}")
    return tree, faults


def _refuse_late_base(tree: Table, keys: list[str], value: Any) -> None:
    """Raises ``UsageError`` where ``base`` is set of a table that files have filled: all of its keys would hide the new base's."""
    node: Any = tree
    for key in keys[:-1]:
        entries = dict(zip(map(str, range(len(node))), node)) if isinstance(node, tuple) else node
        node = entries.get(key) if isinstance(entries, dict) else None
    if keys[-1] == BASE and isinstance(node, Table) and any(source.label != _SET for source in node.sources.values()):
        path = ".".join(keys[:-1])
        other = f"to take another entry, write --set {path}={value}" if path else "name another entry instead"
        raise UsageError(f"what its base says is read already; {other}")


def _validated(tree: Table, model: type[Model], faults: list[str], resolver: Resolver) -> Model:
    try:
        checked = model.model_validate(tree, strict=True)  # no string for a number; lists are tuples in the tree
    except ValidationError as error:
        raise ConfigError(faults + sentences(error, model, tree, resolver)) from None
    if faults:
        raise ConfigError(faults)
    return checked


def _summary(path: Path) -> str:
    try:
        description = read_toml(path, Source(path.name, path.parent, path.parent)).get("description")
    except ConfigError as error:
        return f"cannot be read: {error}"
    return description.strip() if isinstance(description, str) else _first_comment(path)


def _first_comment(path: Path) -> str:
    lines = (line.strip() for line in path.read_text(encoding="utf-8-sig").splitlines())
    first = next((line for line in lines if line), "")
    return first.lstrip("# ") if first.startswith("#") else ""
