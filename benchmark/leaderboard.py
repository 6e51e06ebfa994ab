"""The result table as rows of text: what the terminal prints and the page shows, from the same summaries."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from benchmark import results
from benchmark.results import Entry, Results
from benchmark.summary import Figure, Summary

HEADINGS = (
    "method", "answered", "wrong", "mean", "sd", "max", "geodesic median", "p95", "label switches", "CPU ms/frame",
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """One entry with its summary (one per sensor) and the texts of its cells, keyed by ``HEADINGS``."""

    entry: Entry
    summary: Summary
    cells: dict[str, str]


def rows(folder: Path, index: Results) -> Iterator[Row]:
    """A row per entry and sensor, in the index's order."""
    for entry in index.entries:
        for summary in results.summaries(folder, entry):
            yield Row(entry, summary, cells(summary))


def cells(summary: Summary) -> dict[str, str]:
    """The texts of one row. Angles in degrees; an em dash where there is nothing to say."""
    swept = summary.swept
    return {
        "method": summary.title,
        "answered": f"{summary.answered}/{summary.frames}",
        "wrong": f"{round(summary.wrong_but_confident * summary.frames)}",
        "mean": "—" if swept is None else f"{swept.mean_deg.value:+.2f}",
        "sd": "—" if swept is None else number(swept.sd_deg.value),
        "max": "—" if swept is None else number(swept.max_deg),
        "geodesic median": figure(summary.geodesic_median_deg),
        "p95": figure(summary.geodesic_p95_deg),
        "label switches": str(summary.label_switches),
        "CPU ms/frame": "—" if summary.cpu_s_per_frame is None else number(1e3 * summary.cpu_s_per_frame),
    }


def figure(value: Figure | None) -> str:
    """A statistic's value, or a dash."""
    return "—" if value is None else number(value.value)


def number(value: float) -> str:
    """Three significant digits without an exponent."""
    return f"{value:.3g}" if abs(value) < 100 else f"{value:.0f}"
