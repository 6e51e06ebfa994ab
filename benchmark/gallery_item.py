"""What a card of the gallery holds, and the words on it."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from benchmark.gallery_choice import Choice, Kind
from benchmark.gallery_layers import Layer
from benchmark.gallery_outlines import Shape
from benchmark.leaderboard import minus

BADGES: dict[Kind, str] = {
    "worst": "worst answer",
    "unanswered": "no answer",
    "wrong": "most wrong elsewhere",
    "more": "worst of a further case",
}
_OUTCOMES = {
    "not_converged": "not converged",
    "no_features": "no features found",
    "timed_out": "timed out",
}


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One sensor's cut-out, ``width`` × ``height`` in the units of ``shapes``; the first of its ``layers`` is the picture."""

    name: str
    width: int
    height: int
    layers: tuple[Layer, ...]
    shapes: tuple[Shape, ...]

    @property
    def kinds(self) -> tuple[str, ...]:
        """Which kinds of shapes there are; of ``true target`` and the like the first word."""
        return tuple(dict.fromkeys(shape.kind.split(" ")[0] for shape in self.shapes))


@dataclass(frozen=True, slots=True, eq=False)
class Item:
    """One frame of one method. ``reason``: the method's own words for having no answer, or empty."""

    key: str
    modality: str
    method: str
    series: int
    badge: str
    heading: str
    verdict: str
    conditions: str
    reason: str
    command: str
    is_answered: bool
    is_wrong: bool
    views: tuple[View, ...]

    @property
    def kinds(self) -> tuple[str, ...]:
        """Which kinds of shapes any view has."""
        return tuple(dict.fromkeys(kind for view in self.views for kind in view.kinds))

    @property
    def layers(self) -> tuple[Layer, ...]:
        """The layers to choose from: those of the first view that has several."""
        return max((view.layers for view in self.views), key=len)

    @property
    def size(self) -> int:
        """How many bytes the pictures and lines are, nearly the card's."""
        uris = sum(len(layer.uri) for view in self.views for layer in view.layers)
        return uris + sum(len(shape.path) for view in self.views for shape in view.shapes)


def item(choice: Choice, number: int, series: int, reason: str, command: str, views: tuple[View, ...]) -> Item:
    """The card of a choice."""
    row = choice.row
    return Item(
        key=f"gallery-{number}",
        modality=str(row["modality"]),
        method=str(row["method"]),
        series=series,
        badge=BADGES[choice.kind],
        heading=f"{row['run']}, {row['subject']}, frame {int(row['frame'])}",
        verdict=verdict(row),
        conditions=conditions(row),
        reason=reason,
        command=command,
        is_answered=bool(row["answered"]),
        is_wrong=bool(row["wrong"]),
        views=views,
    )


def verdict(row: pd.Series) -> str:
    """How far off the answer is, or what came instead of one."""
    if not row["answered"]:
        outcome = str(row["outcome"])
        return f"no answer: {_OUTCOMES.get(outcome, outcome)}"
    text = f"off by {_figures(row['geodesic_deg'])}°"
    if row["modality"] != "mono" and np.isfinite(row["position_error_m"]):
        text += f" and {_metres(float(row['position_error_m']))}"
    return f"{text}: wrong" if row["wrong"] else text


def conditions(row: pd.Series) -> str:
    """When, how far, how lit."""
    parts = [
        (row["time_s"], "{:g} s"),
        (row["range_m"], "{:.1f} m"),
        (row["phase_angle_deg"], "phase angle {:.0f}°"),
        (100 * row["lit_fraction"], "{:.0f} % lit"),
        (100 * row["saturated_fraction"], "{:.1f} % saturated"),
    ]
    return minus(" · ".join(form.format(value) for value, form in parts if np.isfinite(value)))


def _figures(value: float) -> str:
    """Two digits behind the point where the number is small."""
    return f"{value:.2f}" if value < 10 else f"{value:.1f}"


def _metres(value: float) -> str:
    return f"{1000 * value:.0f} mm" if value < 1 else f"{value:.2f} m"
