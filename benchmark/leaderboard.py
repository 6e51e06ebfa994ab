"""The result table as rows of text: what the terminal prints and the page shows, from the same summaries."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmark import filter_cells, results
from benchmark.figure import Figure
from benchmark.results import Entry, Results
from benchmark.ring_summary import RingSummary, ThreeFigures
from benchmark.summary import Summary


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """One entry with its summary (one per sensor) and the texts of its cells, keyed by their column."""

    entry: Entry
    summary: Summary
    cells: dict[str, str]


def rows(folder: Path, index: Results) -> Iterator[Row]:
    """A row per entry and sensor, in the index's order."""
    for entry in index.entries:
        for summary in results.summaries(folder, entry):
            yield Row(entry, summary, cells(summary))


@dataclass(frozen=True, slots=True, eq=False)
class Overall:
    """One method over all its entries: counts, which add up, and its mean CPU time."""

    title: str
    frames: int
    answered: int
    wrong: int
    label_switches: int
    cpu_s_per_frame: float | None


def overall(table: Sequence[Row]) -> list[Overall]:
    """A line per method, in order of appearance. Errors of different features are not averaged, only counts are added."""
    lines = []
    for title in dict.fromkeys(row.entry.title for row in table):
        mine = [row.summary for row in table if row.entry.title == title]
        timed = [(one.cpu_s_per_frame, one.frames) for one in mine if one.cpu_s_per_frame is not None]
        frames = sum(count for _, count in timed)
        lines.append(
            Overall(
                title=title,
                frames=sum(one.frames for one in mine),
                answered=sum(one.answered for one in mine),
                wrong=sum(one.wrong for one in mine),
                label_switches=sum(one.label_switches for one in mine),
                cpu_s_per_frame=sum(cpu * count for cpu, count in timed) / frames if frames else None,
            )
        )
    return lines


def cells(summary: Summary) -> dict[str, str]:
    """The texts of one row. Angles in degrees; an em dash where there is nothing to say."""
    if summary.ring is not None:
        return ring_cells(summary, summary.ring)
    if summary.filter is not None:
        return filter_cells.of_summary(summary, summary.filter)
    swept = summary.swept
    return {
        "method": summary.title,
        "answered": f"{summary.answered}/{summary.frames}",
        "wrong": str(summary.wrong),
        "mean": "—" if swept is None else f"{swept.mean_deg.value:+.2f}",
        "sd": "—" if swept is None else number(swept.sd_deg.value),
        "max": "—" if swept is None else number(swept.max_deg),
        "geodesic median": figure(summary.geodesic_median_deg),
        "p95": figure(summary.geodesic_p95_deg),
        "label switches": str(summary.label_switches),
        "CPU ms/frame": "—" if summary.cpu_s_per_frame is None else f"{1e3 * summary.cpu_s_per_frame:.1f}",
    }


def ring_cells(summary: Summary, ring: RingSummary) -> dict[str, str]:
    """The texts of one row where the method was told of a ring, two lines each. Offsets in millimetres, angles in degrees."""
    noise = None if ring.frame_to_frame is None else ring.frame_to_frame.noise
    return {
        "method": summary.title,
        "answered\nright": f"{summary.answered}/{summary.frames}\n{ring.ring_right}/{ring.ring_judged}",
        "wrong": str(summary.wrong),
        "bias x y z, mm\nsd": f"{_three(ring.bias_mm, '{:+.1f}')}\n{_three(ring.sd_mm, '{:.1f}')}",
        "normal\nmedian\np95": f"{figure(ring.normal_median_deg)}\n{figure(ring.normal_p95_deg)}",
        "about normal": figure(ring.about_normal_median_deg),
        "swaps": str(summary.label_switches),
        "frame to frame z cm": "—" if noise is None else f"{noise.position_cm[2]:.3f}",
        "CPU ms": "—" if summary.cpu_s_per_frame is None else f"{1e3 * summary.cpu_s_per_frame:.1f}",
    }


def _three(figures: ThreeFigures | None, form: str) -> str:
    return "—" if figures is None else " ".join(form.format(one.value) for one in figures)


def figure(value: Figure | None) -> str:
    """A statistic's value, or a dash."""
    return "—" if value is None else number(value.value)


def number(value: float) -> str:
    """Two decimals, so that a column lines up."""
    return f"{value:.2f}"


def minus(text: str) -> str:
    """Hyphens before digits as minus signs, and none before a zero."""
    return re.sub(r"-(?=\d)", "−", re.sub(r"[-+](?=0\.?0*(?!\.?\d))", "", text))
