"""What a section of charts is made of: groups of plots, each with a sentence for those who cannot see it and its numbers."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """One plot as inline SVG; ``summary`` says its main figures in words; ``rows`` are a heading and its numbers, condensed."""

    title: str
    svg: str
    summary: str
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Sign:
    """How a method is drawn: its title (untrusted text) and a small SVG of its line and marker (ours)."""

    title: str
    svg: str


@dataclass(frozen=True, slots=True, eq=False)
class ChartGroup:
    """Plots on one question about one modality; ``key`` is unique on the page, ``legend`` has the methods that are drawn."""

    key: str
    title: str
    caption: str
    plots: tuple[Chart, ...]
    legend: tuple[Sign, ...] = ()
    is_small: bool = False
