"""The maps of a study's direction factors: how well one could know the pose, and what each method made of it."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from benchmark.ranking_cells import figure, interval, short
from benchmark.ranking_record import Estimate
from benchmark.study.record import FactorRecord
from benchmark.study.score_record import LevelScore, StudyScores
from benchmark.study.sphere_map import STEPS, Mark, drawn
from benchmark.subjects import NAMES
from scenes.arrays import Floats

_SHARES = (0.2, 0.4, 0.6, 0.8, 0.9)  # of right answers: the last class is what counts as available
_DEG = 180 / np.pi
Value = Callable[[LevelScore], float | None]


@dataclass(frozen=True, slots=True, eq=False)
class Map:
    """One map with the edges of its colour classes, each a text, from the worst; ``nothing`` says what an empty cell means.

    ``summary``: its main figures in words. ``is_bound``: whether it tells of the light alone.
    """

    title: str
    svg: str
    classes: tuple[str, ...]
    nothing: str
    summary: str
    is_bound: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class MapGroup:
    """The maps of one factor and modality; ``rows``: a heading and the numbers behind them, a row per direction and method."""

    key: str
    title: str
    maps: tuple[Map, ...]
    rows: tuple[tuple[str, ...], ...]


def map_groups(factors: Sequence[FactorRecord], scores: StudyScores) -> Iterator[MapGroup]:
    """A group for each direction factor and modality."""
    for factor in factors:
        for modality in NAMES if factor.kind == "direction" else ():
            mine = [one for one in scores.levels if one.factor == factor.name and one.modality == modality and one.direction]
            if mine:
                title = f"{NAMES[modality]}: {factor.title}"
                yield MapGroup(f"map-{factor.name}-{modality}", title, tuple(_maps(mine)), tuple(_rows(mine)))


def _maps(levels: list[LevelScore]) -> Iterator[Map]:
    """Errors of all methods share their colours; the bound, far below them, has its own."""
    methods = list(dict.fromkeys(one.method for one in levels))
    of_one = [one for one in levels if one.method == methods[0]]
    if any(one.bound_determined.value is not None for one in of_one):
        yield _errors("What the light allows: σ of the attitude", of_one, _bound_deg, _edges(of_one, _bound_deg), "undetermined")
    edges = _edges(levels, _error_deg)
    for method in methods:
        mine = [one for one in levels if one.method == method]
        yield _shares(f"{method}: frames answered right", mine)
        yield _errors(f"{method}: median error of right answers", mine, _error_deg, edges, "none right")


def _bound_deg(one: LevelScore) -> float | None:
    return None if one.bound_median_rad.value is None else _DEG * one.bound_median_rad.value


def _error_deg(one: LevelScore) -> float | None:
    return one.rotation_median_deg.value


def _shares(title: str, levels: list[LevelScore]) -> Map:
    """A cross is drawn where fewer than nine in ten are right."""

    def mark(one: LevelScore) -> Mark:
        share = one.availability.value or 0.0
        step = int(np.searchsorted(_SHARES, share, side="right"))
        return _mark(one, step, f"{share:.0%} right", crossed=share < _SHARES[-1])

    classes = tuple(f"{100 * low:.0f}–{100 * high:.0f} %" for low, high in pairwise((0.0, *_SHARES, 1.0)))
    broken = sum((one.availability.value or 0.0) < _SHARES[-1] for one in levels)
    worst = min(levels, key=lambda one: one.availability.value or 0.0)
    least = f"the least, {worst.availability.value or 0.0:.0%}, at {worst.label}"
    said = f"Fewer than 90 % right in {broken} of {len(levels)} directions; {least}."
    return Map(title, drawn([mark(one) for one in levels], title), classes, "× fewer than 90 % right", said)


def _edges(levels: list[LevelScore], value: Value) -> Floats:
    """Of classes that are equal in the logarithm between the least and the largest."""
    known = [found for one in levels if (found := value(one)) is not None and found > 0]
    low, high = (min(known), max(known)) if known else (0.1, 1.0)
    return np.geomspace(low, max(high, 1.01 * low), STEPS + 1)


def _errors(title: str, levels: list[LevelScore], value: Value, edges: Floats, nothing: str) -> Map:
    def mark(one: LevelScore) -> Mark:
        found = value(one)
        if found is None:
            return _mark(one, None, nothing, crossed=True)
        step = int(np.clip(np.searchsorted(edges, found, side="right") - 1, 0, STEPS - 1))
        return _mark(one, STEPS - 1 - step, f"{short(found)}°", crossed=False)

    classes = tuple(f"{short(first)}–{short(last)}°" for first, last in pairwise(edges))[::-1]
    known = sorted((found, one.label) for one in levels if (found := value(one)) is not None)
    said = f"{nothing.capitalize()} in {len(levels) - len(known)} of {len(levels)} directions."
    if known:
        (low, least), (high, most) = known[0], known[-1]
        said = f"From {short(low)}° at {least} to {short(high)}° at {most}. {said}"
    svg = drawn([mark(one) for one in levels], title)
    return Map(title, svg, classes, f"× hatched: {nothing}", said, is_bound=value is _bound_deg)


def _mark(one: LevelScore, step: int | None, says: str, crossed: bool) -> Mark:
    return Mark(np.array(one.direction), step, crossed, f"{one.label}: {says}", f"point-{one.points[0]}")


def _rows(levels: list[LevelScore]) -> Iterator[tuple[str, ...]]:
    yield "direction", "method", "% right", "error, ° median", "bound, ° σ", "score × 1000"
    for one in levels:
        error, bound = _with_interval(one.rotation_median_deg, 1.0), figure(one.bound_median_rad, _DEG)
        if bound == "—" and one.bound_determined.value is not None:
            bound = "undetermined"
        yield one.label, one.method, _with_interval(one.availability, 1e2), error, bound, _with_interval(one.charge, 1e3)


def _with_interval(one: Estimate, scale: float) -> str:
    between = interval(one, scale)
    return figure(one, scale) + (f" ({between})" if between else "")
