"""report.html: one self-contained page from a folder of results. Nothing in it is fetched from a network."""

from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from benchmark import report_views as views
from benchmark.figure import Figure
from benchmark.files import publish
from benchmark.filter_cells import fitting
from benchmark.filter_states import STATES
from benchmark.filter_summary import CONVERGED_INERTIA, STEADY
from benchmark.leaderboard import minus, rows
from benchmark.made_by import UNKNOWN
from benchmark.metrics import WRONG_DEG
from benchmark.papers import papers
from benchmark.pool import pool
from benchmark.ranking import ranking
from benchmark.report_board import boards
from benchmark.report_charts import charts
from benchmark.report_gallery import gallery
from benchmark.report_lidar_pictures import LEGEND
from benchmark.report_methods import method_views, slugs_of
from benchmark.report_rectangle_views import is_constant
from benchmark.report_ring_pictures import LIGHT_STATES
from benchmark.report_told import told_in_short
from benchmark.results import read
from benchmark.ring_scores import WRONG_OF_RANGE

PAGE = "report.html"
_KNOWN: dict[str, Any] = {
    "wrong_deg": WRONG_DEG,
    "wrong_of_range": WRONG_OF_RANGE,
    "light_states": LIGHT_STATES,
    "states": STATES,
    "converged_inertia": CONVERGED_INERTIA,
    "steady": STEADY,
    "scan_legend": LEGEND,
}

_SECTIONS = (
    ("leaderboard", "Leaderboard"),
    ("methods", "Methods"),
    ("cases", "Cases"),
    ("explore", "Explore"),
    ("gallery", "Failures"),
    ("papers", "Papers"),
    ("provenance", "Provenance"),
)


def write(folder: Path) -> Path:
    """Makes the page of the results in ``folder`` and returns its path."""
    html = environment().get_template("report.html.j2").render(known=_KNOWN, **_gathered(folder))
    publish(folder, {PAGE: html.encode()})
    return folder / PAGE


def _gathered(folder: Path) -> dict[str, Any]:
    """What the templates show: pure data of these results."""
    index = read(folder)
    titles = list(dict.fromkeys(entry.title for entry in index.entries))
    listed, frames = list(rows(folder, index)), pool(folder, index)
    found, of_papers, shelves = ranking(frames), papers(folder, index), gallery(folder, index, frames, titles)
    drawn = charts(frames, titles)
    absent = {name for name, there in (("papers", of_papers), ("gallery", shelves), ("explore", drawn)) if not there}
    return {
        "index": index,
        "made_by": index.command or UNKNOWN,
        "rule": found.rule,
        "boards": boards(found, titles, told_in_short(listed)),
        "methods": method_views(folder, listed, frames, found, titles),
        "cases": views.cases(folder, index, listed, frames, titles),
        "constant": [row for row in listed if is_constant(row.summary)],
        "charts": drawn,
        "gallery": shelves,
        "papers": of_papers,
        "slugs": slugs_of(titles),
        "sections": [one for one in _SECTIONS if one[0] not in absent],
    }


def environment() -> Environment:
    """What templates are read with: everything is escaped that is not said to be markup."""
    loader = PackageLoader("benchmark", "templates")
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["interval"] = _interval
    environment.filters["minus"] = minus
    environment.filters["fitting"] = fitting
    return environment


def _interval(one: Figure | None) -> str:
    return "" if one is None or one.low is None else minus(f"{one.low:.2f} … {one.high:.2f}")
