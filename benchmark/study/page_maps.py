"""The maps of a study's direction factors: how well one could know the pose, and what each method made of it."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from benchmark.ranking_cells import short
from benchmark.study.record import FactorRecord
from benchmark.study.score_record import LevelScore, StudyScores
from benchmark.study.sphere_map import STEPS, Mark, drawn
from benchmark.subjects import NAMES

_SHARES = (0.2, 0.4, 0.6, 0.8, 0.9)  # of right answers: the last class is what counts as available


@dataclass(frozen=True, slots=True, eq=False)
class Map:
    """One map with the edges of its colour classes, each a text; ``nothing`` says what an empty mark means."""

    title: str
    svg: str
    classes: tuple[str, ...]
    nothing: str


@dataclass(frozen=True, slots=True, eq=False)
class MapGroup:
    """The maps of one factor and modality."""

    key: str
    title: str
    maps: tuple[Map, ...]


def map_groups(factors: Sequence[FactorRecord], scores: StudyScores) -> Iterator[MapGroup]:
    """A group for each direction factor and modality."""
    for factor in factors:
        for modality in NAMES if factor.kind == "direction" else ():
            mine = [one for one in scores.levels if one.factor == factor.name and one.modality == modality and one.direction]
            if mine:
                yield MapGroup(f"map-{factor.name}-{modality}", f"{NAMES[modality]}: {factor.title}", tuple(_maps(mine)))


def _maps(levels: list[LevelScore]) -> Iterator[Map]:
    methods = list(dict.fromkeys(one.method for one in levels))
    of_one = [one for one in levels if one.method == methods[0]]
    if any(one.bound_determined.value is not None for one in of_one):
        yield _errors("How well one could know: σ of the attitude", of_one, _bound_deg, "undetermined")
    for method in methods:
        mine = [one for one in levels if one.method == method]
        yield _shares(f"{method}: frames answered right", mine)
        yield _errors(f"{method}: median error of right answers", mine, lambda one: one.rotation_median_deg.value, "none right")


def _bound_deg(one: LevelScore) -> float | None:
    return None if one.bound_median_rad.value is None else float(np.degrees(one.bound_median_rad.value))


def _shares(title: str, levels: list[LevelScore]) -> Map:
    """Dark is good; a cross is drawn where fewer than nine in ten are right."""

    def mark(one: LevelScore) -> Mark:
        share = one.availability.value or 0.0
        step = int(np.searchsorted(_SHARES, share, side="right"))
        return _mark(one, step, f"{share:.0%} right", crossed=share < _SHARES[-1])

    classes = tuple(f"{low:.0%}–{high:.0%}" for low, high in zip((0.0, *_SHARES), (*_SHARES, 1.0)))
    return Map(title, drawn([mark(one) for one in levels], title), classes, "×: fewer than 90 % right")


def _errors(title: str, levels: list[LevelScore], value: Callable[[LevelScore], float | None], nothing: str) -> Map:
    """Dark is good: six classes, equal in the logarithm between the least and the largest."""
    known = np.array([found for one in levels if (found := value(one)) is not None and found > 0])
    low, high = (known.min(), known.max()) if known.size else (0.1, 1.0)
    edges = np.geomspace(low, max(high, 1.01 * low), STEPS + 1)

    def mark(one: LevelScore) -> Mark:
        found = value(one)
        if found is None:
            return _mark(one, None, nothing, crossed=True)
        step = int(np.clip(np.searchsorted(edges, found, side="right") - 1, 0, STEPS - 1))
        return _mark(one, STEPS - 1 - step, f"{short(found)}°", crossed=False)

    classes = tuple(f"{short(first)}–{short(last)}°" for first, last in pairwise(edges))[::-1]
    return Map(title, drawn([mark(one) for one in levels], title), classes, f"empty: {nothing}")


def _mark(one: LevelScore, step: int | None, says: str, crossed: bool) -> Mark:
    return Mark(np.array(one.direction), step, crossed, f"{one.label}: {says}", f"point-{one.points[0]}")
