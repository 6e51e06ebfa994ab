"""Draws docking-ring.png beside it: a rig's pictures in four lights, what our method measures in them, what the light did."""

from pathlib import Path
from types import MappingProxyType
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

from estimators import registry
from renderer.generate import FrameMaker
from renderer.masks import Light
from scenes.dataset_frame import FrameRecord
from scenes.features import CircleFeature
from scenes.recording import Image, Knowledge, Observation, Ring, StereoPair
from scenes.scenario import Scenario, load_scenario

CASES = {
    "shu2020-exp1": (0, "3.45 m, laboratory light"),
    "shu2020-exp3": (0, "5.2 m, oblique halogen lamp"),
    "ring-sun-glint": (12, "5 m, sun near the mirror direction"),
    "ring-terminator": (10, "5 m, grazing sun, Earthshine"),
}
STATES = {  # the later one is drawn over the earlier
    Light.LIT: "#e8e4d9",
    Light.SPECULAR: "#f6c244",
    Light.ATTACHED_SHADOW: "#31436b",
    Light.CAST_SHADOW: "#7d5ba6",
    Light.SATURATED: "#ef6a3a",
}
AXES = ("#ff5252", "#4ade80", "#60a5fa")
PAPER, INK = "#0e1116", "#d7dce3"
MARGIN = 1.62  # of the ring's radius, around its centre


def main() -> None:
    """Renders, measures, draws, saves."""
    plt.rcParams.update({"text.color": INK, "font.size": 9, "axes.edgecolor": "#39424e", "font.family": "DejaVu Sans"})
    figure, axes = plt.subplots(3, len(CASES), figsize=(12.4, 9.9), facecolor=PAPER, gridspec_kw={"hspace": 0.03, "wspace": 0.03})
    for column, (name, (frame, title)) in zip(axes.T, CASES.items(), strict=True):
        case = load_scenario(name, ["quality=standard"])
        column[0].set_title(title, fontsize=9.5, pad=6)
        draw(column, case, FrameMaker(case).record(frame))
    figure.subplots_adjust(left=0.055, right=0.995, top=0.965, bottom=0.04)
    legend = [Patch(color=colour, label=state.name.lower().replace("_", " ")) for state, colour in STATES.items() if state.name]
    figure.legend(handles=legend, ncols=5, loc="lower center", frameon=False, labelcolor=INK, fontsize=9)
    figure.savefig(Path(__file__).with_name("docking-ring.png"), dpi=110, facecolor=PAPER)


def draw(column: Any, case: Scenario, record: FrameRecord) -> None:
    """Both views with the measured ellipse and the answered axes, and the states of the left one."""
    ring = next(one for one in case.target.features if isinstance(one, CircleFeature) and one.name == "ring")
    (rig_name,) = case.rigs
    left, right = case.sensors
    pair = StereoPair(left, right, case.rigs[rig_name].right_from_left)
    answer = measured(case, record, pair, ring)
    for axis, view, camera in ((column[0], "left", left), (column[1], "right", right)):
        lens = case.sensors[camera].intrinsics
        centre, half = window(record, camera, lens, ring)
        axis.imshow((np.maximum(record.images[camera] - 4.0, 0) / 251) ** (1 / 2), cmap="gray", vmin=0, vmax=1)
        frame_on(axis, centre, half, f"{view} picture")
        if answer.sensor_from_target is not None:
            overlay(axis, answer, view, pair, lens, ring)
    lens = case.sensors[left].intrinsics
    mask = np.zeros((lens.height_px, lens.width_px))
    bits = record.layers[left]["mask"]
    states = np.zeros(bits.shape)
    for value, bit in enumerate(STATES, start=1):
        states[(bits & np.uint32(bit)) > 0] = value
    mask[record.windows[left].slices] = states
    column[2].imshow(mask, cmap=ListedColormap(["#000000", *STATES.values()]), vmin=0, vmax=len(STATES), interpolation="nearest")
    frame_on(column[2], *window(record, left, lens, ring), "what the light did")


def measured(case: Scenario, record: FrameRecord, pair: StereoPair, ring: CircleFeature) -> Any:
    """Our method's answer to this one pair, found from scratch."""
    method = registry.load("stereo-ring")
    sensors = {name: camera.model for name, camera in case.sensors.items()}
    method.start(Knowledge(sensors, pair=pair, ring=Ring(ring.name, ring.target_from_feature)))
    images = MappingProxyType({name: Image(pixels) for name, pixels in record.images.items()})
    return method.step(Observation(record.frame, record.time_s, images))


def window(record: FrameRecord, camera: str, lens: Any, ring: CircleFeature) -> tuple[Any, float]:
    """Where the ring is and half the side of the cut-out, pixels."""
    from scenes.pose_columns import pose

    edge = lens.project(pose(record.truth[camera]).apply(np.array(ring.points_target(90))))
    return edge.mean(axis=0), MARGIN * float(np.ptp(edge, axis=0).max()) / 2


def overlay(axis: Any, answer: Any, view: str, pair: StereoPair, lens: Any, ring: CircleFeature) -> None:
    """The measured ellipse and the ring's axes at the answered pose."""
    from scipy.spatial.transform import RigidTransform

    a, b, theta = (answer.extras[f"{view}_{name}"] for name in ("a_px", "b_px", "theta_rad"))
    t = np.linspace(0, 2 * np.pi, 200)
    c, s = np.cos(theta), np.sin(theta)
    x = answer.extras[f"{view}_x_px"] + a * np.cos(t) * c - b * np.sin(t) * s
    y = answer.extras[f"{view}_y_px"] + a * np.cos(t) * s + b * np.sin(t) * c
    axis.plot(x, y, color="#ffb020", linewidth=1.0)
    left_from_target = RigidTransform.from_components(answer.translation_m, answer.sensor_from_target)
    cam_from_target = left_from_target if view == "left" else pair.right_from_left * left_from_target
    ends = lens.project((cam_from_target * ring.target_from_feature).apply(np.vstack([np.zeros(3), 0.45 * np.eye(3)])))
    for end, colour in zip(ends[1:], AXES, strict=True):
        axis.annotate("", xy=end, xytext=ends[0], arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.6})


def frame_on(axis: Any, centre: Any, half: float, text: str) -> None:
    """Cuts out; no ticks; the text stands to the left of the left column only."""
    axis.set(xticks=[], yticks=[], xlim=(centre[0] - half, centre[0] + half), ylim=(centre[1] + half, centre[1] - half))
    if axis.get_subplotspec().colspan.start == 0:
        axis.set_ylabel(text, fontsize=9, color=INK, labelpad=6)


if __name__ == "__main__":
    main()
