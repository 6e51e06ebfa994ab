"""Places in a chart that lead to the frames behind a point: drawn as unseen squares, made links in the finished SVG."""

import re
from collections.abc import Sequence
from html import escape

from matplotlib.axes import Axes

from scenes.arrays import Floats

_SIZE = 90.0  # of a square, in points²: a finger's width on a phone is more, but neighbours must not hide each other
Target = tuple[str, str]
"""A point's name, and what is said of it there."""


def place(axes: Axes, across: Floats | Sequence[float], up: Floats | Sequence[float], first: int) -> None:
    """Squares at (n,) places, whose targets will be those from number ``first`` on. NaN has none."""
    urls = [f"target:{first + number}" for number in range(len(across))]
    axes.scatter(across, up, s=_SIZE, c="none", edgecolors="none", marker="s", urls=urls, zorder=9, clip_on=False)


def linked(svg: str, targets: Sequence[Target]) -> str:
    """The finished SVG with links for its squares; not one picture any more, but a group with parts."""

    def link(found: re.Match[str]) -> str:
        name, says = targets[int(found[1])]
        return f'<a href="#point-{escape(name)}" tabindex="-1" aria-label="{escape(says)}"><title>{escape(says)}</title>'

    svg = re.sub(r'<a xlink:href="target:(\d+)"[^>]*>', link, svg)
    return svg.replace('role="img"', 'role="group"', 1)
