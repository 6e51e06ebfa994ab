"""What a paper printed for a stereo case, figure by figure, with what every method here comes to beside it."""

from collections.abc import Sequence
from dataclasses import dataclass

from benchmark.suite import PublishedRing
from benchmark.summary import Summary


@dataclass(frozen=True, slots=True, eq=False)
class Cell:
    """A figure of ours beside a printed one; None where there is none."""

    value: float | None
    is_met: bool


@dataclass(frozen=True, slots=True, eq=False)
class PrintedRow:
    """One printed figure and ours, a cell for each method."""

    what: str
    printed: float | None
    cells: tuple[Cell, ...]


@dataclass(frozen=True, slots=True, eq=False)
class PrintedView:
    """What a paper printed for a case, with the reason for what is not met."""

    source: str
    rows: tuple[PrintedRow, ...]
    reason: str
    is_uniform: bool

    @property
    def is_met(self) -> bool:
        """Whether every figure of every method is at most the printed one."""
        return all(cell.is_met for row in self.rows for cell in row.cells)


def printed_view(printed: PublishedRing, summaries: Sequence[Summary]) -> PrintedView:
    """The printed figures in rows, three of position, three of rotation and the time, with a cell for each of ``summaries``."""
    motions = [None if one.ring is None else one.ring.frame_to_frame for one in summaries]
    rows = []
    for place, axis in enumerate("xyz"):
        ours = [None if one is None else one.noise.position_cm[place] for one in motions]
        rows.append(_row(f"position {axis} (cm)", printed.f2f_position_cm[place], ours))
    for place, axis in enumerate("xyz"):
        ours = [None if one is None else one.noise.rotation_deg[place] for one in motions]
        rows.append(_row(f"rotation {axis} (deg)", printed.f2f_rotation_deg[place], ours))
    rows.append(_row("time a frame (s)", printed.cpu_s, [one.cpu_s_per_frame for one in summaries]))
    uniform = all(one.is_uniform for one in motions if one is not None)
    return PrintedView(printed.source, tuple(rows), printed.reason, uniform)


def _row(what: str, printed: float | None, ours: Sequence[float | None]) -> PrintedRow:
    return PrintedRow(what, printed, tuple(Cell(one, printed is None or (one is not None and one <= printed)) for one in ours))
