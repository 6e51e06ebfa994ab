"""What a validation found, as sentences: file, key path, what was given, what is allowed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

from pydantic import BaseModel, ValidationError

from scenes.config_keys import allowed_keys
from scenes.config_references import Resolver
from scenes.config_tree import TAGS, KeyPath, Source, Table, dotted, shown
from scenes.errors import nearest

_ARTICLE = {
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "a string",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "dataclass_type": "a table",
    "tuple_type": "a list",
    "list_type": "a list",
}
_BOUNDS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}
_LENGTHS = {
    "too_short": ("at least", "min_length"),
    "too_long": ("at most", "max_length"),
}
_CHOICES = {"union_tag_invalid": "expected_tags", "literal_error": "expected", "enum": "expected"}
_ALLOWED = {
    "missing": "an entry is missing in the list",
    "union_tag_not_found": "must have a key {discriminator} that says what it is",
    "finite_number": "must be a finite number",
    "string_pattern_mismatch": "must match {pattern}",
}


@dataclass(frozen=True, slots=True)
class _Fault:
    path: KeyPath
    source: Source
    given: Any
    error: Mapping[str, Any]

    @property
    def where(self) -> str:
        return f"{self.source.label}: {dotted(self.path)}" if self.path else self.source.label

    @property
    def is_mismatch(self) -> bool:
        return self.error["type"] in _ARTICLE


def sentences(error: ValidationError, model: type[BaseModel], tree: Table, resolver: Resolver) -> list[str]:
    """One sentence a fault, in the order of the model; nothing about key paths that ``resolver`` found broken already."""
    faults = [_located(entry, tree) for entry in error.errors(include_url=False)]
    faults = [fault for fault in faults if not any(fault.path[: len(path)] == path for path in resolver.broken)]
    told = [fault for fault in faults if _is_told(fault, faults)]
    return list(dict.fromkeys(_mismatch(fault, told, resolver) or _sentence(fault, model, tree) for fault in told))


def _is_told(fault: _Fault, faults: list[_Fault]) -> bool:
    """Of the branches of a union, those that do not even fit the value's kind say nothing if another one does.

    Nor does a list whose entries have faults: pydantic leaves them out and then counts too few.
    """
    depth = len(fault.path)
    if fault.error["type"] == "too_short" and any(other.path[:depth] == fault.path != other.path for other in faults):
        return False
    return not fault.is_mismatch or all(other.is_mismatch for other in faults if other.path[:depth] == fault.path)


def _mismatch(fault: _Fault, faults: list[_Fault], resolver: Resolver) -> str:
    """A value of the wrong kind, with all kinds that are allowed there; empty where the fault is another."""
    if not fault.is_mismatch:
        return ""
    kinds = {_ARTICLE[other.error["type"]]: None for other in faults if other.is_mismatch and other.path == fault.path}
    name = " or a name" if resolver.kind(fault.path) else ""
    return f"{fault.where}: got {_typed(fault.given)}, must be {' or '.join(kinds)}{name}"


def _sentence(fault: _Fault, model: type[BaseModel], tree: Table) -> str:
    if fault.error["type"] != "extra_forbidden":
        return f"{fault.where}: {_reason(fault)}"
    allowed = allowed_keys(model, fault.error["loc"], _at(tree, fault.path[:-1]))
    hint = nearest(str(fault.path[-1]), allowed)
    return f"{fault.where}: no such key{hint} (got {shown(fault.given)}; allowed: {', '.join(allowed)})"


def _reason(fault: _Fault) -> str:
    """Everything after the key path, for all but wrong types and unknown keys."""
    kind, context, given = fault.error["type"], fault.error.get("ctx", {}), shown(fault.given)
    if kind in _BOUNDS:
        words, name = _BOUNDS[kind]
        return f"got {given}, must be {words} {context[name]:g}"
    if kind in _LENGTHS:
        words, name = _LENGTHS[kind]
        return f"got {given}, must have {words} {context[name]} entries"
    if kind in _CHOICES:
        return _one_of(fault.given, context[_CHOICES[kind]])
    if kind == "value_error":
        return str(context["error"])
    if kind == "missing" and isinstance(fault.error["loc"][-1], str):
        return "it is missing"
    return f"got {given}, {_ALLOWED.get(kind, fault.error['msg']).format(**context)}"


def _one_of(given: Any, expected: str) -> str:
    choices = [choice.strip().strip("'") for choice in expected.replace(" or ", ", ").split(",")]
    hint = nearest(given, choices) if isinstance(given, str) else ""
    return f"got {shown(given)}, must be one of {', '.join(choices)}{hint}"


def _typed(value: Any) -> str:
    kinds = {bool: "true or false", str: "a string", int: "a whole number", float: "a number", tuple: "a list"}
    kind = next((name for type_, name in kinds.items() if isinstance(value, type_)), "")
    return f"{shown(value)} ({kind})" if kind and not isinstance(value, Mapping) else shown(value)


def _at(tree: Table, path: KeyPath) -> Any:
    node: Any = tree
    for key in path:
        node = node[key]
    return node


def _located(error: Mapping[str, Any], tree: Table) -> _Fault:
    """Follows pydantic's location through the tree, leaving out what only names a branch of a union."""
    node: Any = tree
    source, path = tree.origin, cast(KeyPath, ())
    for key in error["loc"]:
        if isinstance(node, Table) and key in node:
            source, node = node.sources[key], node[key]
        elif isinstance(node, tuple) and isinstance(key, int) and key < len(node):
            node = node[key]
        else:
            continue
        path = (*path, key)
        source = node.origin if isinstance(node, Table) and error["loc"][-1] != "[key]" else source
    last = error["loc"][-1] if error["loc"] else 0
    if error["type"] == "missing" and isinstance(last, str):
        return _Fault((*path, last), source, None, error)
    if error["type"] == "union_tag_invalid" and isinstance(node, Table):
        tag = next((name for name in TAGS if name in node), TAGS[0])
        return _Fault((*path, tag), node.sources.get(tag, source), node.get(tag), error)
    return _Fault(path, source, path[-1] if last == "[key]" else node, error)
