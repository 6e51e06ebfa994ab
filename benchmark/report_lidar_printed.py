"""What a paper printed for a LIDAR case, state by state, with what every method here comes to beside it."""

from collections.abc import Sequence
from dataclasses import dataclass

from benchmark.filter_seeds import Pooled, SeedsLine
from benchmark.filter_states import STATES, State
from benchmark.published import PublishedFilter


@dataclass(frozen=True, slots=True, eq=False)
class FilterCell:
    """A method's figure of one state beside the printed one; ``pooled`` None where it does not give the state."""

    pooled: Pooled | None
    is_met: bool


@dataclass(frozen=True, slots=True, eq=False)
class FilterRow:
    """One printed figure and ours, a cell for each method."""

    state: State
    printed: float
    cells: tuple[FilterCell, ...]
    reason: str

    @property
    def is_met(self) -> bool:
        """Whether every method that gives the state meets the figure."""
        return all(cell.is_met or cell.pooled is None for cell in self.cells)


@dataclass(frozen=True, slots=True, eq=False)
class PrintedFilterView:
    """What a paper printed for a case."""

    source: str
    rows: tuple[FilterRow, ...]


def printed_filter_view(printed: PublishedFilter, lines: Sequence[SeedsLine]) -> PrintedFilterView:
    """The printed figures in rows with a cell for each of ``lines``."""
    figures, rows = printed.figures, []
    for state in STATES:
        level = figures[state.key]
        if level is not None:
            cells = tuple(_cell(line.states.get(state.key), level) for line in lines)
            rows.append(FilterRow(state, level, cells, printed.reasons.get(state.key, "")))
    return PrintedFilterView(printed.source, tuple(rows))


def _cell(pooled: Pooled | None, level: float) -> FilterCell:
    met = pooled is not None and pooled.lost == 0 and pooled.worst is not None and pooled.worst <= level
    return FilterCell(pooled, met)
