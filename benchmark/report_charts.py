"""The page's charts from the pooled frames: overview, distributions, error against time and against conditions, by modality."""

from collections.abc import Iterator, Sequence

import pandas as pd

from benchmark.chart_cdf import cdf_charts
from benchmark.chart_conditions import condition_charts
from benchmark.chart_frames import by_method, divisions, with_errors
from benchmark.chart_group import Chart, ChartGroup, Sign
from benchmark.chart_overview import overview_charts
from benchmark.chart_style import sign
from benchmark.chart_time import panels, time_charts
from benchmark.ranking_cells import some
from benchmark.subjects import NAMES

__all__ = ["Chart", "ChartGroup", "charts"]

_LINES = "Dotted: SPEED's threshold, below which an error counts as none. Dashed: an answer that far off is wrong."
_EDGE = "A bar that runs to the edge has its end among frames without an answer."
_OVERVIEW = f"Medians are over all frames, one without an answer being larger than any error. {_EDGE} {_LINES}"
_CDF = f"A curve ends at the share of frames that was answered: what is missing there to 100 % has no answer. {_LINES}"
_TIME = (
    "Line: the median of the answers of a stretch of time and of all seeds; band: from the least to the largest. Points: single "
    f"frames. Crosses at the foot: frames without an answer. {_LINES}"
)
_CONDITIONS = (
    "Median over all frames of a bin with its 95 % bootstrap interval, none where most frames have no answer; below, the answered "
    f"share. Bins hold about equally many frames, or one value each. {_EDGE} {_LINES}"
)
_BY_DIVISION = (
    ("overview", "accuracy, availability and cost", _OVERVIEW, overview_charts),
    ("cdf", "errors of all frames", _CDF, cdf_charts),
    ("conditions", "error against range and light", _CONDITIONS, condition_charts),
)


def charts(frames: pd.DataFrame, titles: Sequence[str]) -> tuple[ChartGroup, ...]:
    """Groups of charts of the pooled ``frames``; a method is drawn by its place in ``titles``. None where there are no frames.

    Methods share a chart only where they were asked for the same tracks. What does not vary has no chart. Pure: equal frames
    give equal bytes.
    """
    places = {title: place for place, title in enumerate(dict.fromkeys([*titles, *frames["method"]]))}
    return tuple(group for modality in NAMES for group in _modality(frames, modality, places) if group.plots)


def _modality(frames: pd.DataFrame, modality: str, places: dict[str, int]) -> Iterator[ChartGroup]:
    """The groups of one modality, some of them perhaps without plots."""
    mine = frames[frames["modality"] == modality]
    if mine.empty:
        return
    mine = with_errors(mine)
    parts, more = divisions(mine)
    name, short = NAMES[modality], modality[0]
    apart = "" if len(parts) + more == 1 else " Methods stand together where they were asked for the same tracks."
    left = f" {more} smaller sets of tracks are left out." if more else ""
    for key, what, caption, draw in _BY_DIVISION:
        begin = f"{short}{key[1]}"
        plots = tuple(plot for number, part in enumerate(parts) for plot in draw(part, places, f"{begin}{number}"))
        yield ChartGroup(f"{modality}-{key}", f"{name}: {what}", caption + apart + left, plots, _legend(mine, places, begin))
    yield _over_time(mine, modality, places)


def _over_time(mine: pd.DataFrame, modality: str, places: dict[str, int]) -> ChartGroup:
    """Small panels, one a case and subject, and a word on those that are left out."""
    begin = f"{modality[0]}i"
    shown, rest = panels(mine)
    left = f" Not shown: {some(rest)}." if rest else ""
    plots = tuple(time_charts(shown, mine, places, begin))
    title = f"{NAMES[modality]}: error against time"
    return ChartGroup(f"{modality}-time", title, _TIME + left, plots, _legend(mine, places, begin), is_small=True)


def _legend(mine: pd.DataFrame, places: dict[str, int], begin: str) -> tuple[Sign, ...]:
    return tuple(Sign(title, sign(place, f"{begin}s{place}-")) for title, place, _ in by_method(mine, places))
