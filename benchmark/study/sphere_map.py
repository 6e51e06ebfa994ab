"""Maps of the sphere of light directions: two discs of equal area, what lies behind the camera and what lies behind the target.

Lambert's azimuthal equal-area projection (Snyder 1987, chapter 24), so that every direction of a study has the same area. Right and
left, above and below are as the camera sees them, in both discs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from benchmark.study.sphere_cells import cells
from scenes.arrays import Floats

_RADIUS, _GAP, _SIDE, _ABOVE, _BELOW = 100.0, 50.0, 24.0, 38.0, 24.0  # of a disc; between the two; around them
_RINGS_DEG = (30, 60)
STEPS = 6
"""Colour classes beside the one for nothing known."""


@dataclass(frozen=True, slots=True, eq=False)
class Mark:
    """One direction (3,): ``step`` of the scale from 0, None where there is nothing to show; ``crossed`` draws a cross over it."""

    direction: Floats
    step: int | None
    crossed: bool
    name: str
    link: str


def projected(directions: Floats) -> Floats:
    """(n, 2) of (n, 3): right and down in the disc of the side that they lie on, 0 in the middle, length 1 at the rim."""
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    length, across = np.sqrt(np.maximum(1 - np.abs(unit[:, 2]), 0)), np.hypot(unit[:, 0], unit[:, 1])
    scale = np.divide(length, across, out=np.zeros_like(length), where=across > 0)
    return np.asarray(unit[:, :2] * scale[:, None])


def drawn(marks: Sequence[Mark], label: str) -> str:
    """The map as an SVG; each direction's cell is a link to its point's pictures."""
    directions = np.array([one.direction for one in marks], dtype=np.float64).reshape(-1, 3)
    width, height = 2 * _SIDE + 4 * _RADIUS + _GAP, _ABOVE + 2 * _RADIUS + _BELOW
    parts = [f'<svg viewBox="0 0 {width:.0f} {height:.0f}" class="sphere" role="group" aria-label="{escape(label)}">']
    parts += [_disc(place) for place in (0, 1)]
    parts += [_cell(one, *halves) for one, halves in zip(marks, cells(directions), strict=True)]
    parts += [_cross(one) for one in marks if one.crossed]
    parts += [_words(place) for place in (0, 1)]
    return "".join([*parts, "</svg>"])


def _cell(one: Mark, toward: Floats, away: Floats) -> str:
    name, shade = escape(one.name), "none" if one.step is None else f"s{one.step}"
    parts = [_outline(half, place) for place, half in enumerate((toward, away)) if len(half)]
    halves = "".join(f'<path class="{shade}" d="{outline}"/>' for outline in parts)
    return f'<a href="#{escape(one.link)}" tabindex="-1" aria-label="{name}"><title>{name}</title>{halves}</a>'


def _outline(half: Floats, place: int) -> str:
    return "M" + " ".join(f"{x:.1f},{y:.1f}" for x, y in _centre(place) + _RADIUS * projected(half)) + "z"


def _cross(one: Mark) -> str:
    (x, y), half = _centre(int(one.direction[2] > 0)) + _RADIUS * projected(one.direction[None])[0], 4.0
    left, right, top, bottom = (f"{one:.1f}" for one in (x - half, x + half, y - half, y + half))
    lines = f"M{left},{top} {right},{bottom}M{left},{bottom} {right},{top}"
    return f'<path class="halo" d="{lines}"/><path class="cross" d="{lines}"/>'


def _centre(place: int) -> Floats:
    return np.array([_SIDE + _RADIUS + place * (2 * _RADIUS + _GAP), _ABOVE + _RADIUS])


def _disc(place: int) -> str:
    x, y = _centre(place)
    return f'<circle class="disc" cx="{x:.0f}" cy="{y:.0f}" r="{_RADIUS:.0f}"/>'


def _words(place: int) -> str:
    """Circles of equal phase angle with their numbers, what lies in the middle, and which side is which."""
    x, y = _centre(place)
    parts = [f'<circle class="ring" cx="{x:.0f}" cy="{y:.0f}" r="{_RADIUS:.0f}"/>']
    for angle in _RINGS_DEG:
        radius = _RADIUS * np.sqrt(1 - np.cos(np.radians(angle)))
        parts.append(f'<circle class="ring" cx="{x:.0f}" cy="{y:.0f}" r="{radius:.1f}"/>')
        parts.append(_text(x, y + radius + 4, f"{angle if place == 0 else 180 - angle}°", "angle"))
    parts.append(_text(x, 12, ("light behind the camera", "light behind the target")[place], "side"))
    parts += [_text(x, y - _RADIUS - 5, "above"), _text(x, y + _RADIUS + 15, "below")]
    for beside, word, turn in ((-_RADIUS - 8, "left", -90), (_RADIUS + 8, "right", 90)):
        at = f"translate({x + beside:.0f},{y:.0f}) rotate({turn})"
        parts.append(f'<text transform="{at}" dy="2" text-anchor="middle">{word}</text>')
    return "".join(parts)


def _text(x: float, y: float, word: str, kind: str = "") -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}"{f" class={chr(34)}{kind}{chr(34)}" if kind else ""} text-anchor="middle">{word}</text>'
