"""Draws first-light.png beside it: what a camera sees of two frames, and what only the renderer knows. Run from the checkout."""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.patches import Patch

from renderer.generate import FrameMaker
from renderer.masks import Light
from scenes.dataset_frame import FrameRecord
from scenes.scenario import load_scenario

FRAMES = {
    "zhai2014-out-of-plane": (700, "θ = +34° about Z, shadows and light from wing to body"),
    "zhai2014-in-plane-glint": (650, "θ = +23.1° about Y, the wings mirror the sun into the camera"),
}
LAYERS = {"direct_diffuse": "direct, diffuse", "direct_specular": "direct, mirror-like", "indirect": "indirect"}
STATES = {  # the later one is drawn over the earlier
    Light.LIT: "#e8e4d9",
    Light.ATTACHED_SHADOW: "#31436b",
    Light.CAST_SHADOW: "#7d5ba6",
    Light.SPECULAR: "#f6c244",
    Light.SATURATED: "#ef6a3a",
}
PAPER, INK = "#0e1116", "#d7dce3"
BLACK_DN = 6.0  # the camera's black level
SCALE = (0.05, 300.0)  # of the light layers, logarithmic
HALF_WIDTH_PX, HALF_HEIGHT_PX = 262, 62


def main() -> None:
    """Renders, draws, saves."""
    plt.rcParams.update({"text.color": INK, "font.size": 9, "axes.edgecolor": "#39424e", "font.family": "DejaVu Sans"})
    figure, axes = plt.subplots(6, 2, figsize=(11, 8.2), facecolor=PAPER, gridspec_kw={"hspace": 0.06, "wspace": 0.02})
    for column, (name, (frame, title)) in zip(axes.T, FRAMES.items(), strict=True):
        record = FrameMaker(load_scenario(name, ["quality=standard"])).record(frame)
        column[0].set_title(title, fontsize=9.5, pad=6)
        draw(column, record)
    figure.subplots_adjust(left=0.138, right=0.995, top=0.965, bottom=0.045)
    legend = [Patch(color=colour, label=state.name.lower().replace("_", " ")) for state, colour in STATES.items() if state.name]
    figure.legend(handles=legend, ncols=5, loc="lower center", frameon=False, labelcolor=INK, fontsize=9)
    figure.savefig(Path(__file__).with_name("first-light.png"), dpi=130, facecolor=PAPER)


def draw(column: Any, record: FrameRecord) -> None:
    """One frame from top to bottom: the picture, the light layers on one logarithmic scale, the states, the depth."""
    picture, layers = cropped(record)
    column[0].imshow((np.maximum(picture - BLACK_DN, 0) / (255 - BLACK_DN)) ** (1 / 1.8), cmap="gray", vmin=0, vmax=1)
    label(column[0], "picture, DN")
    for axis, (name, text) in zip(column[1:4], LAYERS.items(), strict=True):
        axis.imshow(np.maximum(layers[name], 1e-3), cmap="inferno", norm=LogNorm(*SCALE))
        label(axis, f"{text}\n{SCALE[0]:g}–{SCALE[1]:g} W m⁻² sr⁻¹")
    states = np.zeros(picture.shape)
    for value, bit in enumerate(STATES, start=1):
        states[(layers["mask"] & bit) > 0] = value
    column[4].imshow(states, cmap=ListedColormap(["#000000", *STATES.values()]), vmin=0, vmax=len(STATES), interpolation="nearest")
    label(column[4], "what the light did")
    depth = np.where(layers["part_id"] > 0, layers["z_m"], np.nan)
    column[5].set_facecolor("black")
    column[5].imshow(depth, cmap="viridis_r")
    label(column[5], "depth along the axis")
    corner = {"x": 0.985, "y": 0.06, "ha": "right", "fontsize": 8, "transform": column[5].transAxes}
    column[5].text(s=f"{np.nanmin(depth):.1f} to {np.nanmax(depth):.1f} m", **corner)


def cropped(record: FrameRecord) -> tuple[Any, dict[str, Any]]:
    """Picture and layers around the target, of one size for all frames."""
    picture, window = record.images["nav"].astype(np.float64), record.windows["nav"]
    y, x = window.y_px + window.height_px // 2, window.x_px + window.width_px // 2
    around = slice(y - HALF_HEIGHT_PX, y + HALF_HEIGHT_PX), slice(x - HALF_WIDTH_PX, x + HALF_WIDTH_PX)
    layers = {}
    for name, layer in record.layers["nav"].items():
        full = np.zeros(picture.shape, layer.dtype)
        full[window.slices] = layer
        layers[name] = full[around]
    return picture[around], layers


def label(axis: Any, text: str) -> None:
    """No ticks; the text stands to the left of the left column only."""
    axis.set(xticks=[], yticks=[])
    if axis.get_subplotspec().colspan.start == 0:
        axis.set_ylabel(text, rotation=0, ha="right", va="center", labelpad=8, fontsize=9, color=INK)


if __name__ == "__main__":
    main()
