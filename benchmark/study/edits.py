"""Changing a scenario's tree: key paths that lead through tables and lists, where parts are called by their names."""

from collections.abc import Callable, Mapping
from copy import deepcopy
from typing import Any

from scenes.errors import UsageError, unknown

Tree = dict[str, Any]
Change = Callable[[Any], Any]


def edited(tree: Tree, path: str, change: Change) -> Tree:
    """A copy of ``tree`` with what lies at ``path`` replaced by ``change`` of it.

    ``path``: keys with dots between them. In a list a key is a number or an entry's ``name``; ``*`` stands for every key, and
    leaves out those in which the rest of the path leads nowhere. Raises ``UsageError`` where it leads nowhere at all.
    """
    copy = deepcopy(tree)
    _descend(copy, path.split("."), change, ())
    return copy


def found(tree: Tree, path: str) -> list[Any]:
    """Everything that lies at ``path``."""
    values: list[Any] = []

    def look(value: Any) -> Any:
        values.append(value)
        return value

    edited(tree, path, look)
    return values


def times(factor: float) -> Change:
    """Multiplies a number, every number of a list, or the ``value`` of a quantity over wavelengths."""

    def change(value: Any) -> Any:
        if isinstance(value, bool) or value is None or isinstance(value, str):
            raise UsageError(f"{value!r} is not a number, so it cannot be multiplied")
        if isinstance(value, Mapping):
            if "value" not in value:
                raise UsageError("it is a table without numbers under 'value', so it cannot be multiplied")
            return {**value, "value": change(value["value"])}
        return [change(one) for one in value] if isinstance(value, list | tuple) else value * factor

    return change


def _descend(node: Any, keys: list[str], change: Change, done: tuple[str, ...]) -> None:
    """Changes ``node`` in place."""
    key, rest = keys[0], keys[1:]
    if key == "*":
        _everywhere(node, rest, change, done)
        return
    place = _place(node, key, done)
    if rest:
        _descend(node[place], rest, change, (*done, key))
        return
    try:
        node[place] = change(node[place])
    except UsageError as error:
        raise UsageError(f"{'.'.join((*done, key))}: {error}") from None


def _everywhere(node: Any, rest: list[str], change: Change, done: tuple[str, ...]) -> None:
    places = list(node) if isinstance(node, Mapping) else range(len(node)) if isinstance(node, list) else ()
    reached = 0
    for place in places:
        if not _leads_somewhere(node[place], rest):
            continue
        reached += 1
        if rest:
            _descend(node[place], rest, change, (*done, str(place)))
        else:
            node[place] = change(node[place])
    if not reached:
        raise UsageError(f"{'.'.join(done)}: nothing in it has {'.'.join(rest) or 'any entry'}")


def _leads_somewhere(node: Any, keys: list[str]) -> bool:
    try:
        _descend(deepcopy(node), keys, lambda value: value, ()) if keys else None
    except UsageError:
        return False
    return True


def _place(node: Any, key: str, done: tuple[str, ...]) -> Any:
    """Where ``key`` lies in ``node``: a table's key, a list's place by number or by an entry's name."""
    where = ".".join(done) or "the scenario"
    if isinstance(node, Mapping):
        if key not in node:
            raise UsageError(f"{where}: {unknown('key', key, node)}")
        return key
    if not isinstance(node, list):
        raise UsageError(f"{where} is neither a table nor a list, so it has no {key!r}")
    if key.isdecimal() and int(key) < len(node):
        return int(key)
    names = [one.get("name") for one in node if isinstance(one, Mapping)]
    if key not in names:
        raise UsageError(f"{where}: {unknown('entry', key, [str(name) for name in names if name])}")
    return names.index(key)
