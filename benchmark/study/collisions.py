"""Factors that stand in each other's way: columns of one name, places that are changed twice, changes that are lost."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

from benchmark.study.edits import Tree, edited, found
from scenes.errors import UsageError

_OURS = ("point", "moved", "label")  # columns of points.parquet that are no factor's


def columns_twice(factors: Mapping[str, Any]) -> list[str]:
    """Sentences about names that would be one column of points.parquet."""
    columns = Counter(_OURS)
    for name, factor in factors.items():
        columns.update([f"{name}_{axis}" for axis in "xyz"] if factor.dimensions == 2 else [name])
    return [
        f"factors.{name}: the table of points has a column of that name already; call it otherwise"
        for name in factors
        if columns[name] > 1
    ]


def path_twice(factor: Any, tree: Tree) -> str | None:
    """The first of a factor's paths that leads to what another one changed already: multiplied, it would be so twice."""
    for path in getattr(factor, "paths", ()):
        try:
            if any(value is ... for value in found(tree, path)):
                return str(path)
        except UsageError:  # it leads into what another one changed as a whole
            return str(path)
        tree = edited(tree, path, lambda _: ...)
    return None


def lost(factors: Mapping[str, Any], tree: Tree) -> list[str]:
    """Sentences about factors of which nothing is left where a later one is applied too, so that their levels would all be one."""
    faults = []
    names = list(factors)
    for place, name in enumerate(names):
        factor = factors[name]
        low, high = (factor.applied(tree, factor.at(np.full(factor.dimensions, share))) for share in (0.25, 0.75))
        for later in names[place + 1 :] if low != high else ():
            other = factors[later]
            value = other.at(np.full(other.dimensions, 0.5))
            if other.applied(low, value) == other.applied(high, value):
                faults.append(f"factors.{later}: it replaces what factors.{name} changes, so their combinations say nothing")
    return faults
