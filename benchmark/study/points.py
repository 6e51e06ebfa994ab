"""The points of a study: settings of all factors, each with the scenario that it makes."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from types import MappingProxyType

import numpy as np
import pandas as pd
from pydantic import ValidationError

from benchmark.study.edits import Tree
from benchmark.study.factor import Value
from benchmark.study.record import factor_records
from benchmark.study.spec import Study, case_of
from scenes.arrays import Floats
from scenes.errors import UsageError
from scenes.provenance import sha256_of_json
from scenes.scenario import Scenario

_DIGITS = 10  # of a digest: names of some thousand points are told apart


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """One setting. ``name``: after the content, so the same setting has the same name in every design.

    ``values``: of each factor, None where the scenario's own value is no level of it. ``moved``: the factor that is off what the
    scenario has, in one-at-a-time designs.
    """

    name: str
    values: Mapping[str, Value | None]
    moved: str
    label: str
    scenario: Scenario


def points(study: Study) -> tuple[Point, ...]:
    """All points in the design's order; those of a Sobol design in SALib's, which may hold one twice."""
    tree = study.scenario.model_dump(mode="json")
    match study.design:
        case "one-at-a-time":
            return tuple(_one_at_a_time(study, tree))
        case "factorial" | "sphere":
            levels = (factor.values for factor in study.factors.values())
            return tuple(_point(study, tree, dict(zip(study.factors, chosen))) for chosen in product(*levels))
        case "sobol":
            from benchmark.study.problem import samples

            unit = samples(factor_records(study), study.samples, study.seed)
            return tuple(point_at(study, row, tree) for row in unit)


def point_at(study: Study, unit: Floats, tree: Tree | None = None) -> Point:
    """The point at a place (dimensions,) of the unit cube, whose axes are the factors' in their order."""
    values, at = {}, 0
    for name, factor in study.factors.items():
        values[name] = factor.at(np.asarray(unit[at : at + factor.dimensions]))
        at += factor.dimensions
    return _point(study, study.scenario.model_dump(mode="json") if tree is None else tree, values)


def dimensions(study: Study) -> int:
    """Of the unit cube that all settings are drawn from."""
    return sum(factor.dimensions for factor in study.factors.values())


def table(study: Study, chosen: tuple[Point, ...]) -> pd.DataFrame:
    """A row per point: ``point``, ``moved``, ``label``, and of each factor its number, or a direction's ``_x``, ``_y``, ``_z``."""
    rows = []
    for point in chosen:
        row: dict[str, object] = {"point": point.name, "moved": point.moved, "label": point.label}
        for name, factor in study.factors.items():
            value = point.values[name]
            if factor.dimensions == 2:
                parts = value if isinstance(value, tuple) else (np.nan,) * 3
                row |= {f"{name}_{axis}": part for axis, part in zip("xyz", parts)}
            else:
                row[name] = np.nan if value is None else value
        rows.append(row)
    return pd.DataFrame(rows)


def _one_at_a_time(study: Study, tree: Tree) -> Iterator[Point]:
    """The scenario as it is, then each factor's levels but the one that it has."""
    own = {name: factor.baseline(tree) for name, factor in study.factors.items()}
    yield _finished(study, tree, own, "", "as the scenario is")
    for name, factor in study.factors.items():
        for value in factor.values:
            if not _equal(value, own[name]):
                label = f"{factor.title} {factor.label(value)}"
                yield _finished(study, factor.applied(tree, value), {**own, name: value}, name, label)


def _equal(value: Value, own: Value | None) -> bool:
    return own is not None and bool(np.allclose(value, own, rtol=1e-9, atol=1e-12))


def _point(study: Study, tree: Tree, values: Mapping[str, Value | None]) -> Point:
    said = []
    for name, factor in study.factors.items():
        value = values[name]
        assert value is not None  # levels are values
        tree = factor.applied(tree, value)
        said.append(f"{factor.title} {factor.label(value)}")
    return _finished(study, tree, values, "", ", ".join(said))


def _finished(study: Study, tree: Tree, values: Mapping[str, Value | None], moved: str, label: str) -> Point:
    try:
        scenario = Scenario.model_validate(tree)
        case_of(study, f"p{'0' * _DIGITS}", label, scenario)  # its frames may be gone
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(key) for key in first["loc"])
        said = first["msg"].removeprefix("Value error, ")
        raise UsageError(f"at {label} the scenario is refused: {f'{place}: ' if place else ''}{said}") from None
    digest = sha256_of_json([scenario.model_dump(mode="json"), study.quality, study.frames, study.seeds])
    return Point(f"p{digest[:_DIGITS]}", MappingProxyType(dict(values)), moved, label, scenario)
