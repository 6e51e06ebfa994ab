"""Methods by name. They are found through the entry-point group ``hardlight.estimators``, ours and anybody else's alike.

Listing imports none of them, so that a method with heavy dependencies, or a broken one, costs nothing until it is chosen.
A method that is not installed is named by ``package.module:Class`` and may lie in the working directory.
"""

import sys
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

from estimators.api import Estimator
from estimators.refusals import refusal
from scenes.errors import UsageError, unknown

GROUP = "hardlight.estimators"


def names() -> tuple[str, ...]:
    """The installed methods, in the order of the alphabet; nothing is imported."""
    return tuple(sorted(_installed()))


def load(name: str, /, **parameters: object) -> Estimator:
    """A fresh estimator of the method ``name`` or ``package.module:Class``, built with ``parameters``.

    Raises ``UsageError`` for an unknown name (with the nearest one), a module that does not import, a class that is not
    there or does not have ``start`` and ``step``, and parameters that it refuses.
    """
    estimator = _built(name, _factory(name), parameters)
    if not isinstance(estimator, Estimator):
        raise UsageError(f"method {name!r} gives a {type(estimator).__name__}, which has no start and step")
    return estimator


def _installed() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points(group=GROUP)}


def _factory(name: str) -> Callable[..., object]:
    installed = _installed()
    if name not in installed and ":" not in name:
        raise UsageError(unknown("method", name, installed))
    if name not in installed:
        _search_working_directory()
    module, _, attribute = (installed[name].value if name in installed else name).partition(":")
    try:
        found: object = import_module(module)
        for part in attribute.split("."):
            found = getattr(found, part)
    except ImportError as error:
        raise UsageError(f"method {name!r}: module {module!r} does not import: {error}") from error
    except (AttributeError, ValueError) as error:
        raise UsageError(f"method {name!r}: module {module!r} has no {attribute!r}") from error
    if not callable(found):
        raise UsageError(f"method {name!r}: {attribute!r} of module {module!r} is not a class")
    return found


def _search_working_directory() -> None:
    """Lets a module in the working directory be imported, which a console script does not do by itself.

    It is searched last, so that a file of the user's that happens to be called like a package of ours shadows nothing.
    """
    here = str(Path.cwd())
    if here not in sys.path and "" not in sys.path:
        sys.path.append(here)


def _built(name: str, factory: Callable[..., object], parameters: dict[str, object]) -> object:
    try:
        return factory(**parameters)
    except (TypeError, ValueError) as error:
        raise UsageError(f"method {name!r} refuses {refusal(error, factory, parameters)}") from error
