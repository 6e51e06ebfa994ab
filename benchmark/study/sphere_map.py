"""Maps of the sphere of light directions: two discs of equal area, what lies behind the camera and what lies behind the target.

Lambert's azimuthal equal-area projection (Snyder 1987, chapter 24), so that every direction of a study has the same area. Right and
left, above and below are as the camera sees them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from scenes.arrays import Floats

_RADIUS, _GAP, _MARGIN = 100.0, 26.0, 16.0  # of a disc; between the two; around them
_RINGS_DEG = (30, 60, 90)
_FILL = 0.94  # of its share of the area that a mark's disc has: neighbours touch
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


def placed(direction: Floats) -> tuple[float, float]:
    """Where a direction lies in the map's drawing."""
    x, y, z = direction / np.linalg.norm(direction)
    front = z <= 0
    length = np.sqrt(max(2 * (1 - abs(z)), 0.0)) / np.sqrt(2.0)  # 0 in the middle, 1 at the rim, where z is 0
    across = np.hypot(x, y)
    right, down = (x / across * length, y / across * length) if across > 0 else (0.0, 0.0)
    centre = _MARGIN + _RADIUS + (0.0 if front else 2 * _RADIUS + _GAP)
    return float(centre + _RADIUS * right), float(_MARGIN + _RADIUS + _RADIUS * down)


def drawn(marks: Sequence[Mark], label: str) -> str:
    """The map as an SVG; each mark is a link to its point's pictures."""
    radius = _FILL * _RADIUS * np.sqrt(2 / len(marks))
    width, height = 2 * _MARGIN + 4 * _RADIUS + _GAP, 2 * _MARGIN + 2 * _RADIUS
    parts = [f'<svg viewBox="0 0 {width:.0f} {height:.0f}" class="sphere" role="group" aria-label="{escape(label)}">']
    parts += [_disc(place) for place in (0, 1)]
    parts += [_mark(one, radius) for one in marks]
    parts += [_rings(place) for place in (0, 1)]
    return "".join([*parts, "</svg>"])


def _disc(place: int) -> str:
    return f'<circle class="disc" cx="{_centre(place):.0f}" cy="{_MARGIN + _RADIUS:.0f}" r="{_RADIUS:.0f}"/>'


def _rings(place: int) -> str:
    """Circles of equal phase angle, and which side is which."""
    x, y = _centre(place), _MARGIN + _RADIUS
    circles = "".join(
        f'<circle class="ring" cx="{x:.0f}" cy="{y:.0f}" r="{_RADIUS * np.sqrt(1 - np.cos(np.radians(angle))):.1f}"/>'
        for angle in _RINGS_DEG
    )
    words = ("phase 0° in the middle", "phase 180° in the middle")[place]
    sides = ((-_RADIUS - 4, "above"), (_RADIUS + 11, f"below; {words}"))
    texts = "".join(f'<text x="{x:.0f}" y="{y + down:.0f}" text-anchor="middle">{word}</text>' for down, word in sides)
    return circles + texts


def _centre(place: int) -> float:
    return _MARGIN + _RADIUS + place * (2 * _RADIUS + _GAP)


def _mark(one: Mark, radius: float) -> str:
    x, y = placed(one.direction)
    shade = "none" if one.step is None else f"s{one.step}"
    name = escape(one.name)
    (left, right), (top, bottom) = ((at - 0.45 * radius, at + 0.45 * radius) for at in (x, y))
    lines = f"M{left:.1f},{top:.1f} {right:.1f},{bottom:.1f}M{left:.1f},{bottom:.1f} {right:.1f},{top:.1f}"
    cross = f'<path class="cross" d="{lines}"/>' if one.crossed else ""
    return (
        f'<a href="#{escape(one.link)}" tabindex="-1" aria-label="{name}"><title>{name}</title>'
        f'<circle class="{shade}" cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"/>{cross}</a>'
    )
