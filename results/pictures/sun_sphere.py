"""Draws sun-sphere.png beside it, from the kept scores of the study: what the light allows, and what two methods make of it."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.patches import Circle, Polygon

from benchmark.study import scores
from benchmark.study.score_record import LevelScore
from benchmark.study.sphere_cells import cells
from benchmark.study.sphere_map import projected

HERE = Path(__file__).resolve().parent
PAPER, INK, FAINT = "#0e1116", "#d7dce3", "#39424e"
SIDES = ("behind the camera", "behind the target")
MAPS = (
    ("mono", "mono-rectangle", "bound", "One camera: what the light allows, σ"),
    ("mono", "mono-rectangle", "right", "mono-rectangle: answered right"),
    ("stereo", "stereo-ring", "bound", "Two cameras: what the light allows, σ"),
    ("stereo", "stereo-ring", "right", "stereo-ring: answered right"),
)


def main() -> None:
    """Reads, draws, saves."""
    plt.rcParams.update({"text.color": INK, "font.size": 9, "font.family": "DejaVu Sans"})
    levels = scores.read(HERE.parent / "studies" / "sun-sphere").levels
    figure, axes = plt.subplots(2, 4, figsize=(14.0, 6.6), facecolor=PAPER, gridspec_kw={"wspace": 0.06, "hspace": 0.24})
    for place, (modality, method, what, title) in enumerate(MAPS):
        mine = [one for one in levels if one.modality == modality and one.method == method]
        pair = axes[place // 2, 2 * (place % 2) : 2 * (place % 2) + 2]
        draw(pair, mine, what)
        middle = (pair[0].get_position().x0 + pair[1].get_position().x1) / 2
        figure.text(middle, pair[0].get_position().y1 + 0.045, title, ha="center", fontsize=11)
    words = "σ of the attitude: 0.0003° (bright) to 0.06° (dark), hatched: undetermined. Right: all frames (bright) to none (dark)."
    figure.text(0.5, 0.035, words, ha="center")
    figure.savefig(HERE / "sun-sphere.png", dpi=110, facecolor=PAPER, bbox_inches="tight")


def draw(pair: np.ndarray, levels: list[LevelScore], what: str) -> None:
    """Both discs of one map."""
    directions = np.array([one.direction for one in levels])
    scale = LogNorm(0.0003, 0.06) if what == "bound" else Normalize(0, 1)
    colours = plt.get_cmap("cividis_r" if what == "bound" else "cividis")
    for one, halves in zip(levels, cells(directions), strict=True):
        sigma = one.bound_median_rad.value
        value = None if what == "bound" and sigma is None else np.degrees(sigma) if what == "bound" else one.availability.value
        look = {"facecolor": PAPER, "hatch": "////", "edgecolor": FAINT} if value is None else {"facecolor": colours(scale(value))}
        for axes, half in zip(pair, halves, strict=True):
            if len(half):
                axes.add_patch(Polygon(projected(half), lw=0.4, **({"edgecolor": PAPER} | look)))
    for axes, side in zip(pair, SIDES, strict=True):
        dress(axes, f"sun {side}")


def dress(axes: Axes, title: str) -> None:
    """Circles of equal phase angle, sides, no frame."""
    for angle in (30, 60, 90):
        axes.add_patch(Circle((0, 0), np.sqrt(1 - np.cos(np.radians(angle))), fill=False, lw=0.6, ls=":", edgecolor=INK))
    axes.set(xlim=(-1.05, 1.05), ylim=(1.05, -1.05), aspect="equal")
    axes.set_title(title, color=INK, fontsize=9, pad=3)
    axes.axis("off")


if __name__ == "__main__":
    main()
