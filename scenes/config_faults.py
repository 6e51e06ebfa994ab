"""What a validation found, as sentences: file, key path, what was given, what is allowed."""

from __future__ import annotations

import types
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Union, cast, get_args, get_origin

from pydantic import BaseModel, ValidationError

from scenes.config_tree import TAGS, KeyPath, Source, Table, dotted, shown
from scenes.errors import nearest

_ARTICLE = {
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "a string",
    "bool_type": "true or false",
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


@dataclass(frozen=True, slots=True)
class _Fault:
    path: KeyPath
    source: Source
    given: Any
    error: Mapping[str, Any]

    @property
    def is_mismatch(self) -> bool:
        return self.error["type"] in _ARTICLE


def sentences(error: ValidationError, model: type[BaseModel], tree: Table, broken: Iterable[KeyPath]) -> list[str]:
    """One sentence a fault, in the order of the model; nothing about key paths that are ``broken`` already."""
    faults = [_located(entry, tree) for entry in error.errors(include_url=False)]
    faults = [fault for fault in faults if not any(fault.path[: len(path)] == path for path in broken)]
    return list(dict.fromkeys(_sentence(fault, faults, model, tree) for fault in faults if _is_told(fault, faults)))


def _is_told(fault: _Fault, faults: list[_Fault]) -> bool:
    """Of the branches of a union, those that do not even fit the value's kind say nothing if another one does."""
    depth = len(fault.path)
    return not fault.is_mismatch or all(other.is_mismatch for other in faults if other.path[:depth] == fault.path)


def _sentence(fault: _Fault, faults: list[_Fault], model: type[BaseModel], tree: Table) -> str:
    where = f"{fault.source.label}: {dotted(fault.path)}" if fault.path else fault.source.label
    if fault.is_mismatch:
        kinds = {_ARTICLE[other.error["type"]]: None for other in faults if other.is_mismatch and other.path == fault.path}
        return f"{where}: got {_typed(fault.given)}, must be {' or '.join(kinds)}"
    if fault.error["type"] == "extra_forbidden":
        allowed = _allowed_keys(model, fault, tree)
        key = str(fault.path[-1])
        return f"{where}: no such key{nearest(key, allowed)} (got {shown(fault.given)}; allowed: {', '.join(allowed)})"
    return f"{where}: {_reason(fault)}"


def _reason(fault: _Fault) -> str:
    """Everything after the key path, for all but wrong types and unknown keys."""
    kind, context, given = fault.error["type"], fault.error.get("ctx", {}), shown(fault.given)
    if kind in _BOUNDS:
        words, name = _BOUNDS[kind]
        return f"got {given}, must be {words} {context[name]:g}"
    if kind == "missing":
        return "it is missing" if isinstance(fault.error["loc"][-1], str) else f"got {given}, a value is missing in the list"
    if kind in {"too_short", "too_long"}:
        words, name = ("at least", "min_length") if kind == "too_short" else ("at most", "max_length")
        return f"got {context['actual_length']} entries, must be {words} {context[name]}"
    if kind == "union_tag_invalid":
        return _one_of(fault.given, context["expected_tags"])
    if kind == "union_tag_not_found":
        return f"got {given}, must have a key {context['discriminator']} that says what it is"
    if kind in {"literal_error", "enum"}:
        return _one_of(fault.given, context["expected"])
    fixed = {
        "finite_number": "must be a finite number",
        "string_pattern_mismatch": f"must match {context.get('pattern')}",
        "value_error": f"{context.get('error')}",
    }
    text = fixed.get(kind, f"{fault.error['msg'][:1].lower()}{fault.error['msg'][1:]}")
    return f"{text}" if kind == "value_error" else f"got {given}, {text}"


def _one_of(given: Any, expected: str) -> str:
    choices = [choice.strip().strip("'") for choice in expected.replace(" or ", ", ").split(",")]
    hint = nearest(given, choices) if isinstance(given, str) else ""
    return f"got {shown(given)}, must be one of {', '.join(choices)}{hint}"


def _typed(value: Any) -> str:
    kinds = {bool: "true or false", str: "a string", int: "a whole number", float: "a number", tuple: "a list"}
    kind = next((name for type_, name in kinds.items() if isinstance(value, type_)), "")
    return f"{shown(value)} ({kind})" if kind and not isinstance(value, Mapping) else shown(value)


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
        source = node.origin if isinstance(node, Table) else source
    last = error["loc"][-1] if error["loc"] else 0
    if error["type"] == "missing" and isinstance(last, str):
        return _Fault((*path, last), source, None, error)
    if error["type"] == "union_tag_invalid" and isinstance(node, Table):
        tag = error["ctx"]["discriminator"].strip("'")
        return _Fault((*path, tag), node.sources.get(tag, source), node.get(tag), error)
    return _Fault(path, source, path[-1] if last == "[key]" else node, error)


def _allowed_keys(model: type[BaseModel], fault: _Fault, tree: Table) -> list[str]:
    """The keys of the model that the table with the unknown key is read as."""
    hints: list[Any] = [model]
    for key in fault.error["loc"][:-1]:
        hints = [child for hint in hints for child in _children(hint, key)]
    table: Any = tree
    for key in fault.path[:-1]:
        table = table[key]
    models = [hint for hint in hints if isinstance(hint, type) and issubclass(hint, BaseModel)]
    if fault.path[-1] not in TAGS:  # a table may be read by the model of its type, wherever that is known
        models = [one for one in models if _has_tag(one, table)] or [one for one in _all_models() if _has_tag(one, table)] or models
    return sorted({name for one in models for name in one.model_fields})


def _children(hint: Any, key: str | int) -> list[Any]:
    """The types that ``key`` may have below a type; a key that only names a branch of a union leads nowhere."""
    if isinstance(hint, type) and issubclass(hint, BaseModel):
        return _arms(hint.model_fields[key].annotation) if key in hint.model_fields else [hint]
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is dict:
        return _arms(arguments[1])
    if origin in (tuple, list):
        return [arm for argument in arguments for arm in _arms(argument)]
    return []


def _arms(hint: Any) -> list[Any]:
    """The branches of a type without Annotated and Union around them."""
    if get_origin(hint) is Annotated:
        return _arms(get_args(hint)[0])
    if get_origin(hint) in (Union, types.UnionType):
        return [arm for argument in get_args(hint) for arm in _arms(argument)]
    return [hint]


def _has_tag(model: type[BaseModel], table: Mapping[str, Any]) -> bool:
    fields = [(table.get(tag), model.model_fields.get(tag)) for tag in TAGS]
    return any(field and get_origin(field.annotation) is Literal and tag in get_args(field.annotation) for tag, field in fields)


def _all_models(model: type[BaseModel] = BaseModel) -> Iterator[type[BaseModel]]:
    for child in model.__subclasses__():
        yield child
        yield from _all_models(child)
