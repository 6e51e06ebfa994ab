"""report.html: one self-contained page from a folder of results. Nothing in it is fetched from a network."""

from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from benchmark import report_views as views
from benchmark.figure import Figure
from benchmark.files import publish
from benchmark.filter_cells import fitting
from benchmark.filter_states import STATES
from benchmark.filter_summary import CONVERGED_INERTIA, STEADY
from benchmark.leaderboard import minus, overall, rows
from benchmark.metrics import WRONG_DEG
from benchmark.report_lidar_pictures import LEGEND
from benchmark.report_ring_pictures import LIGHT_STATES
from benchmark.results import read
from benchmark.ring_scores import WRONG_OF_RANGE

PAGE = "report.html"


def write(folder: Path) -> Path:
    """Makes the page of the results in ``folder`` and returns its path."""
    index = read(folder)
    titles = list(dict.fromkeys(entry.title for entry in index.entries))
    shown = views.cases(folder, index, titles)
    html = (
        _environment()
        .get_template("report.html.j2")
        .render(
            index=index,
            cases=shown,
            titles=titles,
            overall=overall(list(rows(folder, index))),
            wrong_deg=WRONG_DEG,
            wrong_of_range=WRONG_OF_RANGE,
            light_states=LIGHT_STATES,
            states=STATES,
            converged_inertia=CONVERGED_INERTIA,
            steady=STEADY,
            scan_legend=LEGEND,
            constant=[row for row in rows(folder, index) if views.is_constant(row.summary)],
            told=views.told(shown),
        )
    )
    publish(folder, {PAGE: html.encode()})
    return folder / PAGE


def _environment() -> Environment:
    loader = PackageLoader("benchmark", "templates")
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["interval"] = _interval
    environment.filters["minus"] = minus
    environment.filters["fitting"] = fitting
    return environment


def _interval(one: Figure | None) -> str:
    return "" if one is None or one.low is None else minus(f"{one.low:.2f} … {one.high:.2f}")
