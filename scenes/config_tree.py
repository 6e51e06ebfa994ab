"""What TOML files say, as one tree that remembers which file each key came from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenes.errors import UsageError

TAGS = ("type", "draw")  # the keys that say which kind of thing a table is
Key = str | int
KeyPath = tuple[Key, ...]


@dataclass(frozen=True, slots=True)
class Source:
    """Where keys come from: ``label`` for error texts, ``folder`` that relative paths start from.

    ``root``: folder that no path may leave, or None where the user named the path on the command line.
    """

    label: str
    folder: Path
    root: Path | None


class Table(dict[str, Any]):
    """A TOML table: ``origin`` is the file it came from, ``sources`` the file of each key."""

    __slots__ = ("origin", "sources")

    def __init__(self, origin: Source) -> None:
        """An empty table."""
        super().__init__()
        self.origin = origin
        self.sources: dict[str, Source] = {}

    def put(self, key: str, value: Any, source: Source) -> None:
        """Sets a key that comes from ``source``."""
        self[key] = value
        self.sources[key] = source


def tabled(value: Any, source: Source) -> Any:
    """A parsed TOML value with every table a ``Table`` of ``source`` and every list a tuple."""
    if isinstance(value, Mapping):
        table = Table(source)
        for key, entry in value.items():
            table.put(key, tabled(entry, source), source)
        return table
    return tuple(tabled(entry, source) for entry in value) if isinstance(value, list) else value


def refined(base: Table, by: Table) -> Table:
    """``base`` with the keys of ``by`` laid over it, table by table; lists and tables of another type are replaced whole."""
    merged = Table(base.origin)
    for key, value in base.items():
        merged.put(key, value, base.sources[key])
    for key, value in by.items():
        old = merged.get(key)
        deeper = isinstance(old, Table) and isinstance(value, Table) and not _is_another_type(old, value)
        merged.put(key, refined(old, value) if deeper else value, by.sources[key])  # type: ignore[arg-type]
    return merged


def assigned(node: Any, path: Sequence[str], value: Any, source: Source, done: tuple[str, ...] = ()) -> Any:
    """``node`` with ``value`` at ``path`` below it (numbers index lists); tables on the way are made.

    Raises ``UsageError`` where the path leads through something that is neither a table nor a list.
    """
    if not path:
        return tabled(value, source)
    key, here = path[0], (*done, path[0])
    if isinstance(node, Table):
        child = assigned(node.get(key, Table(source)), path[1:], value, source, here)
        changed = refined(node, Table(node.origin))
        changed.put(key, child, source if len(path) == 1 else node.sources.get(key, source))
        return changed
    if isinstance(node, tuple):
        place = _place(node, here)
        return (*node[:place], assigned(node[place], path[1:], value, source, here), *node[place + 1 :])
    raise UsageError(f"{dotted(done)} is {shown(node)}, not a table, so it has no {key!r}")


def dotted(path: Sequence[Key]) -> str:
    """A key path as text: ``cameras.nav.f_number``, ``target.parts.0.name``."""
    return ".".join(str(key) for key in path)


def shown(value: Any) -> str:
    """A value as an error text shows it: as in TOML, short."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return f"a table of {', '.join(value)}"[:60] if value else "an empty table"
    if isinstance(value, list | tuple):
        text = f"[{', '.join(shown(entry) for entry in value[:8])}{', ...' if len(value) > 8 else ''}]"
    else:
        text = repr(value) if isinstance(value, str | int | float) else str(value)
    return text if len(text) <= 80 else text[:77] + "..."


def _is_another_type(old: Table, new: Table) -> bool:
    return any(tag in new and new[tag] != old.get(tag) for tag in TAGS)


def _place(node: tuple[Any, ...], path: tuple[str, ...]) -> int:
    key = path[-1]
    if not key.isdecimal() or int(key) >= len(node):
        raise UsageError(f"{dotted(path[:-1])} has {len(node)} entries, 0 to {len(node) - 1}; {key!r} is none of them")
    return int(key)
