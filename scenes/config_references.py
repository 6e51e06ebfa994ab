"""Puts what references name in their place: library entries, files, refined entries, mesh files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from scenes.config_files import LIBRARY, contained, folder_of, locate, read_toml
from scenes.config_tree import Key, KeyPath, Source, Table, dotted, refined, shown
from scenes.errors import AssetError, ConfigError

BASE = "base"  # the key that makes a table a refinement of what it names


@dataclass(frozen=True, slots=True)
class Resolver:
    """Resolves the references of one tree and collects every fault on the way.

    ``references``: key path pattern (``*`` stands for any one key or place) → kind. ``broken``: key paths that could not be
    resolved, about which nothing more need be said.
    """

    references: Mapping[str, str]
    library: Path = LIBRARY
    faults: list[str] = field(default_factory=list)
    broken: set[KeyPath] = field(default_factory=set)

    def resolve(self, value: Any, source: Source, path: KeyPath = (), trail: tuple[Path, ...] = ()) -> Any:
        """``value``, found at ``path`` in ``source``, with everything in it resolved. ``trail``: files that led here."""
        kind = self.kind(path)
        if kind and path not in self.broken:
            value, trail = self._entry(value, source, path, kind, trail)
        if isinstance(value, Table):
            return self._table(value, path, trail)
        if isinstance(value, tuple):
            return tuple(self.resolve(entry, source, (*path, place), trail) for place, entry in enumerate(value))
        return value

    def _table(self, table: Table, path: KeyPath, trail: tuple[Path, ...]) -> Table:
        done = Table(table.origin)
        for key, value in table.items():
            done.put(key, self.resolve(value, table.sources[key], (*path, key), trail), table.sources[key])
        if done.get("type") == "mesh" and isinstance(done.get("path"), str) and (*path, "path") not in self.broken:
            self._mesh(done, (*path, "path"))
        return done

    def _entry(self, value: Any, source: Source, path: KeyPath, kind: str, trail: tuple[Path, ...]) -> tuple[Any, tuple[Path, ...]]:
        """A name becomes the table that it names, a table with ``base`` the refined table."""
        try:
            if isinstance(value, str) and path:
                return self._read(value, source, kind, trail)
            if isinstance(value, Table) and BASE in value:
                return self._refined(value, kind, trail)
        except ConfigError as error:
            self._fault(source, path, error.faults[0])
        return value, trail

    def _read(self, name: str, source: Source, kind: str, trail: tuple[Path, ...]) -> tuple[Table, tuple[Path, ...]]:
        file, origin = locate(name, folder_of(kind), source, self.library)
        real = file.resolve()
        if real in trail:
            raise ConfigError([f"{name!r} names itself by way of {' and '.join(step.name for step in trail)}"])
        table, trail = read_toml(file, origin), (*trail, real)
        return self._refined(table, kind, trail) if BASE in table else (table, trail)

    def _refined(self, value: Table, kind: str, trail: tuple[Path, ...]) -> tuple[Table, tuple[Path, ...]]:
        name, source = value[BASE], value.sources[BASE]
        if not isinstance(name, str):
            raise ConfigError([f"{BASE} is {shown(name)}, must be a name of the library's {folder_of(kind)} or a path"])
        base, trail = self._read(name, source, kind, trail)
        by = Table(value.origin)
        for key in value.keys() - {BASE}:
            by.put(key, value[key], value.sources[key])
        return refined(base, by), trail

    def _mesh(self, table: Table, path: KeyPath) -> None:
        from scenes.assets import check_mesh  # numpy: not needed to list the library

        source = table.sources["path"]
        file = source.folder / table["path"]
        try:
            table["path"] = str(contained(file, source.root) if source.root else file.resolve())
            check_mesh(Path(table["path"]))
        except (ConfigError, AssetError) as error:
            self._fault(source, path, str(error))

    def _fault(self, source: Source, path: KeyPath, text: str) -> None:
        self.broken.add(path)
        self.faults.append(f"{source.label}: {dotted(path)}: {text}" if path else f"{source.label}: {text}")

    def kind(self, path: KeyPath) -> str | None:
        """Of which kind an entry may be named at ``path``; None where a string is just a string."""
        return next((kind for pattern, kind in self.references.items() if _matches(pattern, path)), None)


def _matches(pattern: str, path: tuple[Key, ...]) -> bool:
    wanted = pattern.split(".") if pattern else []
    return len(wanted) == len(path) and all(want in ("*", str(key)) for want, key in zip(wanted, path))
