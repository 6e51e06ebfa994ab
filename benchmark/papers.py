"""The papers' tables: each figure of a paper's results, what the paper's method comes to here, and what ours does beside it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from benchmark.leaderboard import rows
from benchmark.paper_spec import Group, Misprint, Paper, PaperFigure, Place, load_papers
from benchmark.paper_values import Key, Measured, measured
from benchmark.results import Results

Verdict = Literal["met", "not met", "not comparable"]


@dataclass(frozen=True, slots=True, eq=False)
class Cell:
    """One method's figure: None where it has none, with its interval where there is one, and how it stands to the printed one."""

    method: str
    value: float | None
    interval: tuple[float, float] | None
    answered: int
    asked: int
    verdict: Verdict


@dataclass(frozen=True, slots=True, eq=False)
class FigureRow:
    """One printed figure at one place (None where nothing of ours measures it). ``reason``: why not all cells are met."""

    figure: PaperFigure
    place: Place | None
    theirs: tuple[Cell, ...]
    ours: tuple[Cell, ...]
    reason: str

    @property
    def cells(self) -> tuple[Cell, ...]:
        """The paper's method's and ours."""
        return self.theirs + self.ours


@dataclass(frozen=True, slots=True, eq=False)
class GroupView:
    """The rows of one experiment."""

    title: str
    rows: tuple[FigureRow, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Count:
    """In how many of the rows that compare a method meets the printed figure."""

    method: str
    is_ours: bool
    met: int
    compared: int


@dataclass(frozen=True, slots=True, eq=False)
class PaperView:
    """A paper's section: its experiments, how often each method meets it, its misprints, and the reasons, each once."""

    title: str
    year: int
    description: str
    groups: tuple[GroupView, ...]
    counts: tuple[Count, ...]
    reasons: tuple[str, ...]
    misprints: tuple[Misprint, ...]


def papers(folder: Path, index: Results) -> tuple[PaperView, ...]:
    """The sections of those papers of whose experiments the results in ``folder`` hold any; reads nothing but summary.json.

    Raises ``PredictionsError`` where a summary is lost.
    """
    asked = {place.case for paper in load_papers() for place in paper.places}
    if not any(index.bases.get(entry.case, entry.case) in asked for entry in index.entries):
        return ()
    found = measured(rows(folder, index), index.bases)
    views = (view(paper, found) for paper in load_papers())
    return tuple(one for one in views if one.groups)


def view(paper: Paper, found: dict[Key, Measured]) -> PaperView:
    """One paper's section of what is ``found``; an experiment that is not there is left out."""
    groups = tuple(one for one in (_group(paper, group, found) for group in paper.groups) if one is not None)
    listed = [row for group in groups for row in group.rows]
    reasons = dict.fromkeys(row.reason for row in listed if row.reason)
    counts = (*_counts(paper.theirs, listed, is_ours=False), *_counts(paper.ours, listed, is_ours=True))
    return PaperView(paper.title, paper.year, paper.description, groups, counts, tuple(reasons), paper.misprints)


def _group(paper: Paper, group: Group, found: dict[Key, Measured]) -> GroupView | None:
    """None where no method was measured at any of its places."""
    there = [place for place in group.places if _methods_at(place, (*paper.theirs, *paper.ours), found)]
    if not there:
        return None
    listed = []
    for figure in group.figures:
        if figure.quantity is None:
            listed.append(FigureRow(figure, None, (), (), figure.reason))
        else:
            listed += [_row(paper, figure, place, found) for place in there]
    return GroupView(group.title, tuple(listed))


def _methods_at(place: Place, methods: Sequence[str], found: dict[Key, Measured]) -> dict[str, Measured]:
    """Those of ``methods`` that were measured at ``place``, over its number of frames."""
    at = {method: found.get((place.case, place.feature, method)) for method in methods}
    return {method: one for method, one in at.items() if one is not None and one.frames == place.frames}


def _row(paper: Paper, figure: PaperFigure, place: Place, found: dict[Key, Measured]) -> FigureRow:
    theirs, ours = (
        tuple(_cell(figure, method, one) for method, one in _methods_at(place, methods, found).items())
        for methods in (paper.theirs, paper.ours)
    )
    reason = _reason(figure, place) if any(cell.verdict != "met" for cell in theirs + ours) else ""
    return FigureRow(figure, place, theirs, ours, reason)


def _reason(figure: PaperFigure, place: Place) -> str:
    """Of a figure that is compared with nothing its own; else the one for the place."""
    own = figure.reasons.get(place.label, "")
    return own or (place.reason or figure.reason if figure.is_comparable else figure.reason)


def _cell(figure: PaperFigure, method: str, one: Measured) -> Cell:
    assert figure.quantity is not None
    value, over = one.value(figure.quantity), 1.0 if figure.per is None else one.value(figure.per)
    value = None if value is None or not over else figure.scale * value / over
    interval = one.interval(figure.quantity) if figure.per is None and figure.scale == 1.0 else None
    return Cell(method, value, interval, one.answered, one.asked, _verdict(figure, value, one))


def _verdict(figure: PaperFigure, value: float | None, one: Measured) -> Verdict:
    """A method without an answer does not meet a figure; one whose answer does not follow the target is not comparable."""
    if not figure.is_comparable:
        return "not comparable"
    assert figure.printed is not None
    if value is None:
        return "not met"
    if figure.follows is not None:
        slope = one.value("swept.response_slope")
        if slope is None or slope < figure.follows:
            return "not comparable"
    within = abs(value) <= figure.printed if figure.compare == "at most" else value >= figure.printed
    return "met" if within else "not met"


def _counts(methods: Sequence[str], listed: Sequence[FigureRow], *, is_ours: bool) -> Iterator[Count]:
    for method in methods:
        verdicts = [cell.verdict for row in listed for cell in row.cells if cell.method == method]
        compared = [verdict for verdict in verdicts if verdict != "not comparable"]
        if verdicts:
            yield Count(method, is_ours, compared.count("met"), len(compared))
