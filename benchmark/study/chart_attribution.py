"""What of the target was lit, shadowed, specular, saturated against what it cost a method: a panel a layer, a marker a point."""

from collections.abc import Iterator
from typing import get_args

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from benchmark.chart_group import Chart, ChartGroup, Sign
from benchmark.chart_style import canvas, dress, finished, look, sign
from benchmark.leaderboard import minus
from benchmark.ranking_cells import figure, interval, short
from benchmark.ranking_rule import unanswered
from benchmark.report_plots import INK
from benchmark.study.attribution import LAYERS, Attribution
from benchmark.study.chart_links import Target, linked, place
from benchmark.study.outcomes import Outcomes
from benchmark.subjects import NAMES, Modality

_WIDTH_IN, _HEIGHT_IN, _MOST_LINKS = 3.6, 1.7, 400
_CAPTION = (
    "Each marker is a method at a point: mean score over the point's frames, against the mean share of the target's pixels. "
    "Dashed: what a frame without an answer costs. A marker leads to its pictures."
)


def attribution_groups(found: Outcomes, ranked: tuple[Attribution, ...], places: dict[str, int]) -> Iterator[ChartGroup]:
    """A group for each modality with a plot for each layer that varies."""
    for modality in get_args(Modality):
        mine = [one for one in ranked if one.modality == modality]
        frames = found.frames[found.frames["modality"] == modality]
        labels = found.points.drop_duplicates("point").set_index("point")["label"]
        layers = [layer for layer in LAYERS if any(one.correlations[layer].value is not None for one in mine)]
        if not layers:
            continue
        begin = f"a{modality[0]}"
        plots = tuple(_chart(modality, frames, mine, layer, labels, places, f"{begin}{layer[:2]}") for layer in layers)
        legend = tuple(Sign(one.method, sign(places[one.method], f"{begin}s{places[one.method]}-")) for one in mine)
        yield ChartGroup(f"{modality}-light", NAMES[modality], _CAPTION, plots, legend)


def _chart(
    modality: Modality,
    frames: pd.DataFrame,
    ranked: list[Attribution],
    layer: str,
    labels: pd.Series,
    places: dict[str, int],
    prefix: str,
) -> Chart:
    title, targets = f"Score against what was {LAYERS[layer]}", list[Target]()
    summary = f"{title}: " + "; ".join(f"{one.method}: rank correlation {figure(one.correlations[layer])}" for one in ranked)
    with canvas(_WIDTH_IN, [_HEIGHT_IN]) as (drawing, (axes,)):
        for one in ranked:
            means = frames[frames["method"] == one.method].groupby("point", sort=False)[["charge", layer]].mean().dropna()
            across, up = (means[name].to_numpy(dtype=np.float64) for name in (layer, "charge"))
            style = look(places[one.method]) | {"linestyle": "none", "markersize": 4, "alpha": 0.8}
            axes.plot(100 * across, 1000 * up, clip_on=False, **style)
            if len(targets) + len(means) <= _MOST_LINKS:
                place(axes, 100 * across, 1000 * up, len(targets))
                says = zip(means.index, across, up, strict=True)
                targets += [(str(name), _said(one.method, str(labels[name]), at, cost)) for name, at, cost in says]
        _scale(axes, modality)
        dress(axes, f"{LAYERS[layer]} (% of the target)", "score × 1000")
        svg = linked(finished(drawing, f"{prefix}-", summary), targets)
    return Chart(title, svg, summary, tuple(_rows(ranked, layer)))


def _scale(axes: Axes, modality: Modality) -> None:
    cap = 1000 * unanswered(modality)
    axes.axhline(cap, color=INK, linewidth=0.7, linestyle=(0, (4, 2)), alpha=0.75)
    axes.set_ylim(-0.03 * cap, max(1.05 * cap, axes.get_ylim()[1]))


def _said(method: str, label: str, share: float, cost: float) -> str:
    return f"{method} at {label}: {short(1000 * cost)}, share {share:.1%}"


def _rows(ranked: list[Attribution], layer: str) -> Iterator[tuple[str, ...]]:
    yield "method", "points", "rank correlation", "95 % interval"
    for one in ranked:
        rho = one.correlations[layer]
        yield one.method, str(one.points), minus(figure(rho)), minus(interval(rho, between=" to "))
