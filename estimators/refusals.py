"""Parameters that a method refuses, as sentences: which key, what was given, what is allowed, and the nearest name."""

import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from pydantic import BaseModel, ValidationError


def refusal(error: Exception, factory: Callable[..., object], parameters: Mapping[str, object]) -> str:
    """What follows "method 'x' refuses ": each fault's key path and why, or all that was given with the error's own text.

    The model that the parameters are of is looked for by its name beside the method, in the module that defines it.
    """
    model = _model_of(error, factory)
    if isinstance(error, ValidationError) and model is not None:
        return "; ".join(_faults(error, model, parameters))
    given = ", ".join(f"{key}={value!r}" for key, value in parameters.items()) or "no parameters"
    return f"{given}: {_on_one_line(error)}"


def _model_of(error: Exception, factory: Callable[..., object]) -> type[BaseModel] | None:
    module = sys.modules.get(getattr(factory, "__module__", ""))
    found = getattr(module, error.title, None) if isinstance(error, ValidationError) else None
    return found if isinstance(found, type) and issubclass(found, BaseModel) else None


def _faults(error: ValidationError, model: type[BaseModel], parameters: Mapping[str, object]) -> list[str]:
    from scenes.config_faults import sentences
    from scenes.config_references import Resolver
    from scenes.config_tree import Source, tabled

    label = "parameters"
    told = sentences(error, model, tabled(parameters, Source(label, Path(), None)), Resolver({}))
    return [one.removeprefix(f"{label}: ") for one in told]


def _on_one_line(error: Exception) -> str:
    """The error on one line; a pydantic error names each parameter with its fault."""
    if hasattr(error, "errors"):
        return "; ".join(f"{'.'.join(map(str, fault['loc']))}: {fault['msg']}" for fault in error.errors())
    return " ".join(str(error).split())
