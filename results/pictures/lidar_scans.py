"""Draws lidar-scans.png beside it: scans of three tumbling targets, what became of each beam, how far off the ranges are."""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm
from matplotlib.patches import Patch

from renderer.ranging import Scanner
from scenes.beam_fate import BeamFate
from scenes.scenario import load_scenario, realize

FLASH = ("lidars.lidar=flash-1572", "lidars.lidar.mount.position_m=[0, 0, 2]")
ROUGH = "target=rubble"
CASES = {
    "the paper's LIDAR, 64 m": ((), 300),
    "flash at 1572 nm, 64 m": (FLASH, 300),
    "the same flash, upper stage": ((*FLASH, "target=upper-stage"), 120),
    "the same flash, rubble": ((*FLASH, ROUGH), 120),
}
FATES = {
    BeamFate.RETURN: ("a return", "#3b82c4"),
    BeamFate.GRAZING: ("too grazing", "#f6ad55"),
    BeamFate.MIRROR: ("mirrored away", "#e5484d"),
    BeamFate.DARK: ("too dark or far", "#b18cf0"),
    BeamFate.CUT_OFF: ("the paper's dead zone", "#4ade80"),
    BeamFate.FALSE_ALARM: ("noise alone", "#f0f"),
}
PAPER, INK, VOID = "#0e1116", "#d7dce3", "#05070a"
MARGIN = 3  # beams around the target
ROWS = ("strength of the return", "what became of each beam", "measured less true range", "from the side")


def main() -> None:
    """Scans, draws, saves."""
    plt.rcParams.update({"text.color": INK, "font.size": 9, "axes.edgecolor": "#39424e", "font.family": "DejaVu Sans"})
    figure, axes = plt.subplots(4, len(CASES), figsize=(12.4, 12.6), facecolor=PAPER, gridspec_kw={"hspace": 0.04, "wspace": 0.04})
    for column, (title, (overrides, frame)) in zip(axes.T, CASES.items(), strict=True):
        column[0].set_title(title, fontsize=9.5, pad=6)
        scenario = load_scenario("song2017", overrides)
        draw(column, Scanner(scenario, "lidar").take(realize(scenario, scenario.seed, frame)))
    for axis, text in zip(axes[:, 0], ROWS, strict=True):
        axis.set_ylabel(text, fontsize=9, color=INK, labelpad=6)
    figure.subplots_adjust(left=0.035, right=0.995, top=0.97, bottom=0.045)
    legend = [Patch(color=colour, label=text) for text, colour in FATES.values()]
    legend += [Patch(color="#c23b3b", label="+0.2 m"), Patch(color="#3b5bc2", label="−0.2 m")]
    figure.legend(handles=legend, ncols=8, loc="lower center", frameon=False, labelcolor=INK, fontsize=8.5)
    figure.savefig(Path(__file__).with_name("lidar-scans.png"), dpi=110, facecolor=PAPER)


def draw(column: Any, taken: Any) -> None:
    """One column: four looks at one scan, cut to the target."""
    beams, points = taken.beams, taken.scan.points_lidar
    met = np.argwhere(beams["reason"] != BeamFate.NOTHING)
    half = int(np.ptp(met, axis=0).max()) // 2 + MARGIN
    row, place = np.maximum((met.min(axis=0) + met.max(axis=0)) // 2 - half, 0)
    cut = np.s_[row : row + 2 * half + 1, place : place + 2 * half + 1]
    strength = taken.scan.intensity[cut]
    column[0].imshow(strength, norm=LogNorm(*np.nanpercentile(strength, [2, 99])), cmap="viridis", interpolation="nearest")
    numbers = [BeamFate.NOTHING, *FATES]
    shown = np.searchsorted(sorted(numbers), beams["reason"][cut])
    colours = ListedColormap([VOID if fate == BeamFate.NOTHING else FATES[fate][1] for fate in sorted(numbers)])
    steps = BoundaryNorm(np.arange(len(numbers) + 1) - 0.5, len(numbers))
    column[1].imshow(shown, cmap=colours, norm=steps, interpolation="nearest")
    off_m = np.linalg.norm(points.astype(np.float64), axis=-1) - beams["range_m"]
    column[2].imshow(off_m[cut], cmap="coolwarm", vmin=-0.2, vmax=0.2, interpolation="nearest")
    seen = points[beams["reason"] == BeamFate.RETURN]
    column[3].scatter(seen[:, 2], -seen[:, 1], s=1.2, c=-seen[:, 2], cmap="viridis", linewidths=0)
    column[3].set_aspect("equal", adjustable="datalim")
    for axis in column:
        axis.set(xticks=[], yticks=[], facecolor=VOID)


if __name__ == "__main__":
    main()
