"""Which keys a table may have: the way from a model to the model that reads one of its tables."""

from __future__ import annotations

import types
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

from scenes.config_tree import TAGS, Key


def allowed_keys(model: type[BaseModel], location: Sequence[Key], table: Mapping[str, Any]) -> list[str]:
    """The keys of the model that reads ``table``, whose unknown key pydantic found at ``location`` below ``model``."""
    hints: list[Any] = [model]
    for key in location[:-1]:
        hints = [child for hint in hints for child in _children(hint, key)]
    models = [hint for hint in hints if isinstance(hint, type) and issubclass(hint, BaseModel)]
    tagged = [one for one in models if _has_tag(one, table)]
    if not tagged and location[-1] not in TAGS:  # a table may be read by the model of its type, wherever that is known
        tagged = [one for one in _all_models() if _has_tag(one, table)]
    models = tagged or models
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
