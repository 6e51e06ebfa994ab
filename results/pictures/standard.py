"""Draws standard.png beside it: what the suite standard shows its three sensors, a light a row, at the same instant of one seed."""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from benchmark.suite import load_suite
from renderer.generate import settled
from renderer.photograph import Photographer
from renderer.ranging import Scanner
from scenes.pose_columns import pose
from scenes.scenario import Scenario, realize

LIGHTS = {"sun": "sun", "halogen": "halogen lamp", "grazing": "grazing sun", "glint": "glint", "earthshine": "Earthshine"}
COLUMNS = (
    ("nav", "near", "camera, 7 m, cut out"),
    ("nav", "far", "camera, 14 m, cut out"),
    ("stereo-left", "near", "left of the rig, 7 m"),
    ("stereo-left", "mid", "left of the rig, 10 m"),
    ("stereo-left", "far", "left of the rig, 14 m"),
    ("lidar", "near", "LIDAR, 7 m: distances"),
)
SEED, FRAME = 1, 5
PAPER, INK = "#0e1116", "#d7dce3"
HALF_M = 2.7  # of what is cut out of the camera's pictures, around the target


def main() -> None:
    """Renders, draws, saves."""
    plt.rcParams.update({"text.color": INK, "font.size": 9, "axes.edgecolor": "#39424e", "font.family": "DejaVu Sans"})
    figure, axes = plt.subplots(
        len(LIGHTS), len(COLUMNS), figsize=(14.2, 12.2), facecolor=PAPER, gridspec_kw={"hspace": 0.03, "wspace": 0.03}
    )
    suite = load_suite("standard")
    cases = {case.name: settled(case.scenario, SEED, suite.quality) for case in suite.cases}
    for row, (light, title) in zip(axes, LIGHTS.items(), strict=True):
        row[0].set_ylabel(title, fontsize=10, color=INK, labelpad=6)
        for axis, (sensor, place, _) in zip(row, COLUMNS, strict=True):
            draw = scan if sensor == "lidar" else photograph
            draw(axis, cases[f"{light}-{place}"], sensor)
    for axis, (_, _, text) in zip(axes[0], COLUMNS, strict=True):
        axis.set_title(text, fontsize=9.5, pad=6)
    figure.subplots_adjust(left=0.025, right=0.998, top=0.972, bottom=0.006)
    figure.savefig(Path(__file__).with_name("standard.png"), dpi=90, facecolor=PAPER)


def photograph(axis: Any, scenario: Scenario, sensor: str) -> None:
    """One camera's picture, brightened in its dark half; the wide camera's is cut out around the target."""
    photo = Photographer(scenario, sensor).take(realize(scenario, SEED, FRAME))
    lens = scenario.sensors[sensor].intrinsics
    axis.imshow((np.maximum(photo.pixels - 4.0, 0) / 251) ** (1 / 2), cmap="gray", vmin=0, vmax=1)
    axis.set(xticks=[], yticks=[])
    if sensor == "nav":
        sensor_from_target = pose(photo.truth)
        u, v = lens.project(sensor_from_target.apply(np.zeros((1, 3))))[0]
        half = HALF_M * lens.fx_px / sensor_from_target.translation[2]
        axis.set(xlim=(u - half, u + half), ylim=(v + half, v - half))
        axis.set_facecolor("#000000")


def scan(axis: Any, scenario: Scenario, sensor: str) -> None:
    """One scan as a picture of its distances."""
    sounding = Scanner(scenario, sensor).take(realize(scenario, SEED, FRAME))
    range_m = np.linalg.norm(sounding.scan.points_lidar, axis=-1)
    axis.imshow(range_m, cmap="viridis", interpolation="nearest")
    axis.set(xticks=[], yticks=[])
    axis.set_facecolor("#000000")


if __name__ == "__main__":
    main()
