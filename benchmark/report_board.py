"""The leaderboard as the page shows it: a table per division, each figure as a text, as small print and as what it is sorted by."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from benchmark.ranking_cells import counted, figure, interval, rank, ratio, ratio_interval, some
from benchmark.ranking_record import Division, Estimate, Ranking, Standing
from benchmark.subjects import NAMES

_NAMED = 6  # cases that a heading names


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """A figure's heading; ``best`` is what one wants to see first."""

    name: str
    unit: str
    best: Literal["ascending", "descending"] = "ascending"


@dataclass(frozen=True, slots=True, eq=False)
class Cell:
    """A figure, its interval, and the number it is sorted by, None where it falls among the frames without an answer."""

    text: str
    small: str
    value: float | None


@dataclass(frozen=True, slots=True, eq=False)
class BoardLine:
    """One method's line."""

    method: str
    series: int
    rank: int
    rank_text: str
    told: str
    cells: tuple[Cell, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """The paired difference of two methods: the one charged less first, unless it is a tie."""

    first: str
    second: str
    is_tie: bool
    text: str
    small: str


@dataclass(frozen=True, slots=True, eq=False)
class Board:
    """One division. ``about`` says what was asked, ``cases`` all cases by name."""

    title: str
    about: str
    cases: tuple[str, ...]
    columns: tuple[Column, ...]
    lines: tuple[BoardLine, ...]
    pairs: tuple[Pair, ...]


_PLACE = (("position_median_share", "position", "median, ‰"), ("position_p95_share", "position", "p95, ‰"))
_COLUMNS: tuple[tuple[str, float, Column], ...] = (
    ("availability", 1e2, Column("answered", "%", "descending")),
    ("rotation_median_deg", 1.0, Column("rotation", "median, deg")),
    ("rotation_p95_deg", 1.0, Column("rotation", "p95, deg")),
    *((name, 1e3, Column(what, unit)) for name, what, unit in _PLACE),
    ("charge", 1.0, Column("score", "mean charge")),
    ("wrong", 1e2, Column("wrong", "% of frames")),
    ("efficiency", 1.0, Column("efficiency", "1 is the limit", "descending")),
    ("cpu_ms", 1.0, Column("CPU", "ms a frame")),
)


def boards(found: Ranking, titles: Sequence[str], told: Mapping[str, str]) -> tuple[Board, ...]:
    """A table per division; a method's place in ``titles`` is its colour, ``told`` says in short what it was told."""
    return tuple(_board(one, titles, told) for one in found.divisions)


def _board(division: Division, titles: Sequence[str], told: Mapping[str, str]) -> Board:
    hidden = {name for name, _, _ in _PLACE} if division.modality == "mono" else set()
    if all(one.efficiency is None for one in division.methods):
        hidden.add("efficiency")
    shown = [one for one in _COLUMNS if one[0] not in hidden]
    lines = [
        BoardLine(
            method=one.method,
            series=titles.index(one.method),
            rank=one.rank,
            rank_text=rank(one),
            told=told.get(one.method, ""),
            cells=tuple(_ratio(one) if name == "efficiency" else _cell(getattr(one, name), scale) for name, scale, _ in shown),
        )
        for one in division.methods
    ]
    return Board(
        title=NAMES[division.modality],
        about=_about(division),
        cases=division.cases,
        columns=tuple(column for _, _, column in shown),
        lines=tuple(lines),
        pairs=tuple(_pairs(division)),
    )


def _cell(estimate: Estimate | None, scale: float) -> Cell:
    value = None if estimate is None or estimate.value is None else estimate.value
    return Cell(figure(estimate, scale), interval(estimate, scale, " … "), value)


def _ratio(one: Standing) -> Cell:
    value = None if one.efficiency is None else one.efficiency.value
    return Cell(ratio(one.efficiency), ratio_interval(one.efficiency, " … "), value)


def _about(division: Division) -> str:
    """Cases, what was asked for, and how much of it."""
    cases, tracks = some(division.cases, _NAMED), counted(division.tracks, "track")
    return f"{cases}: {', '.join(division.subjects)}; {division.frames} frames in {tracks}"


def _pairs(division: Division) -> list[Pair]:
    """The differences as better minus worse, those of high rank first."""
    places = {one.method: place for place, one in enumerate(division.methods)}
    pairs = []
    for one in division.differences:
        turned = places[one.first] > places[one.second] if one.better is None else one.better != one.first
        first, second = (one.second, one.first) if turned else (one.first, one.second)
        charge = one.charge.negative if turned else one.charge
        pairs.append(Pair(first, second, one.better is None, figure(charge), interval(charge, between=" … ")))
    return sorted(pairs, key=lambda pair: (places[pair.first], places[pair.second]))


def standings(found: Ranking, method: str) -> list[tuple[str, Standing, int]]:
    """Where ``method`` stands: each of its divisions' modality and cases, its standing, among how many."""
    return [
        (f"{NAMES[division.modality]} ({_about(division)})", one, len(division.methods))
        for division in found.divisions
        for one in division.methods
        if one.method == method
    ]
