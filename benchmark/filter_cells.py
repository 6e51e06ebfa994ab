"""The result table of LIDAR methods as texts for the terminal: a line per data set, or per case with its seeds together."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from benchmark.filter_states import STATES, State
from benchmark.filter_summary import Consistency, FilterSummary, StateFigure

_LONG = 1e4

if TYPE_CHECKING:
    from benchmark.filter_seeds import Pooled, SeedsLine
    from benchmark.summary import Summary


def of_summary(summary: "Summary", block: FilterSummary) -> dict[str, str]:
    """One method on one data set."""
    heads = {"method": summary.title, "answered": f"{summary.answered}/{summary.frames}", "wrong": str(summary.wrong)}
    cost = _costs(block.nees, block.icp_attitude_median_deg, summary.cpu_s_per_frame)
    return heads | _states(block.states) | cost


def of_line(line: "SeedsLine") -> dict[str, str]:
    """One method on all seeds of a case."""
    converged = f"{line.converged}/{len(line.rows)}"
    heads = {"method": line.title, "answered": f"{line.answered}/{line.frames}", "converged": converged}
    return heads | _states(line.states) | _costs(line.nees, line.icp_attitude_median_deg, line.cpu_s_per_frame)


def heading(state: State) -> str:
    """A column's name: the state and its unit."""
    return state.key + (f" {state.unit}" if state.unit else "")


def _states(figures: "Mapping[str, StateFigure] | Mapping[str, Pooled]") -> dict[str, str]:
    """3σ of each state's worst component."""
    worst = {state: figures[state.key].worst if state.key in figures else None for state in STATES}
    return {heading(state): _number(value, state.form) for state, value in worst.items()}


def _costs(nees: Consistency | None, icp_deg: float | None, cpu_s: float | None) -> dict[str, str]:
    return {
        "NEES": _number(None if nees is None else nees.mean, "%.1f"),
        "ICP deg": _number(icp_deg, "%.2f"),
        "ms/scan": _number(cpu_s, "%.1f", 1e3),
    }


def fitting(value: float, form: str) -> str:
    """``value`` in ``form``; in two digits where that would be too long for a table."""
    return form % value if abs(value) < _LONG else f"{value:.1e}"


def _number(value: float | None, form: str, scale: float = 1.0) -> str:
    return "—" if value is None else fitting(scale * value, form)
