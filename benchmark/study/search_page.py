"""report.html and worst.png of a search: what hurt most so far over the trials, the ten worst points, the worst one's picture."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmark.files import publish
from benchmark.gallery_item import View, conditions, verdict
from benchmark.leaderboard import minus
from benchmark.report import PAGE, environment
from benchmark.study import search_record
from benchmark.study.outcomes import outcomes
from benchmark.study.search_proposals import Sampler
from benchmark.study.search_record import DARK, TrialRecord, WorstRecord
from benchmark.study.search_worst import PICTURE, costliest, picture, views
from scenes.errors import DatasetError

_SHOWN = 10
_SIZE_IN = (7.0, 2.2)
_SAMPLERS: dict[Sampler, str] = {"tpe": "tree-structured Parzen estimator (Optuna)", "cmaes": "CMA-ES"}


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A row of the table, every cell as it is read."""

    rank: int
    trial: int
    label: str
    right: str
    charge: str
    error: str
    bound: str
    point: str
    is_bad: bool


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """The worst point's costliest frame."""

    heading: str
    verdict: str
    conditions: str
    views: tuple[View, ...]


def write(folder: Path) -> Path:
    """Makes the page of the search in ``folder`` and the picture beside it; returns the page's path."""
    found = search_record.read(folder)
    row = _row(folder, found)
    shown, contents = None, dict[str, bytes]()
    if row is not None:
        shown = _shown(folder, found, row)
        contents[PICTURE] = picture(folder, row)
    text = environment().get_template("worst.html.j2").render(
        record=found,
        made_by=found.command or "hardlight worst",
        sampler=_SAMPLERS[found.sampler],
        startup=found.startup,
        dark=f"{DARK:g}",
        chart=chart(found),
        lines=lines(found),
        shown=shown,
    )
    publish(folder, {**contents, PAGE: text.encode()})
    return folder / PAGE


def lines(found: WorstRecord) -> tuple[Line, ...]:
    """The worst points that count, the worst first, each once."""
    counting = [(place, one) for place, one in enumerate(found.trials) if not one.refused and not one.is_dark]
    unique = {one.point: (place, one) for place, one in reversed(counting)}
    ranked = sorted(unique.values(), key=lambda pair: (-pair[1].value, pair[0]))[:_SHOWN]
    return tuple(_line(found, rank, place, one) for rank, (place, one) in enumerate(ranked, start=1))


def chart(found: WorstRecord) -> str:
    """The mean score of each trial, and the largest so far, as SVG."""
    from matplotlib.ticker import MaxNLocator

    from benchmark.chart_style import canvas, dress, finished
    from benchmark.report_plots import INK, SERIES

    number = np.arange(1, len(found.trials) + 1)
    values = np.array([0.0 if one.refused or one.is_dark else one.value for one in found.trials])
    failed = np.array([one.is_failure for one in found.trials])
    with canvas(_SIZE_IN[0], [_SIZE_IN[1]]) as (figure, (axes,)):
        axes.plot(number, np.maximum.accumulate(values), color=INK, linewidth=1.2, drawstyle="steps-post")
        axes.plot(number[~failed], values[~failed], "o", color=SERIES[1], markersize=4, markerfacecolor="none")
        axes.plot(number[failed], values[failed], "X", color=SERIES[5], markersize=5, markeredgewidth=0)
        axes.axvline(found.startup + 0.5, color=INK, linewidth=0.6, linestyle=(0, (2, 2)))
        axes.set_xlim(0.5, len(number) + 0.5)
        top = max(float(values.max()), 1e-3)
        axes.set_ylim(-0.04 * top, 1.08 * top)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        dress(axes, "trial", "mean score")
        return finished(figure, "search-", f"Mean score over the trials, and the largest so far. {found.sentence}")


def _row(folder: Path, found: WorstRecord) -> pd.Series | None:
    """The frame that is shown; None where no point counts or its data set is gone."""
    if found.worst is None:
        return None
    frames = outcomes(folder).frames
    row = costliest(frames[frames["point"] == found.trials[found.worst].point])
    return row if (folder / str(row["dataset"]) / "frames").is_dir() else None


def _shown(folder: Path, found: WorstRecord, row: pd.Series) -> Shown:
    assert found.worst is not None  # a row was found
    try:
        seen = views(folder, row)
    except DatasetError:
        seen = ()
    heading = f"{found.trials[found.worst].label}, {row['subject']}, frame {int(row['frame'])}"
    return Shown(heading, verdict(row), conditions(row), seen)


def _line(found: WorstRecord, rank: int, place: int, one: TrialRecord) -> Line:
    bound = one.bound_rotation_rad
    if place == found.worst and found.bound is not None:
        bound, asked = found.bound.rotation_rad, True
    else:
        asked = found.avoid_dark
    return Line(
        rank=rank,
        trial=place + 1,
        label=one.label,
        right=f"{one.right}/{one.frames}",
        charge="—" if one.charge is None else minus(f"{one.charge:.4g}"),
        error="—" if one.rotation_median_deg is None else f"{one.rotation_median_deg:.3g}°",
        bound="" if not asked else "undetermined" if bound is None else f"{np.degrees(bound):.2g}°",
        point=one.point,
        is_bad=one.is_failure,
    )
