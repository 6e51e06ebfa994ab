"""The pictures behind a stereo answer: both views with the ellipses and the answered axes, and what the light did there."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.predictions import QUATERNION, TRANSLATION
from benchmark.report_pictures import data_uri, fitted, shown
from benchmark.ring_ellipses import POINTS, measured_ellipse, on_ellipse
from benchmark.ring_subject import RingSubject
from scenes.arrays import Floats
from scenes.dataset import Dataset
from scenes.intrinsics import Intrinsics

# What the light did, as bits of the mask layer, and its colour on the page; a later entry covers an earlier one. Bare metal is
# specular wherever any light falls on it, so a shadow covers that.
LIGHT_STATES = (
    ("lit", 1, "#e8d8a0"),
    ("specular", 8, "#4fb3bf"),
    ("attached shadow", 2, "#34507a"),
    ("cast shadow", 4, "#8a3f8f"),
    ("saturated", 16, "#d9480f"),
)
AXIS_COLOURS = ("#ff5252", "#4ade80", "#60a5fa")  # x, y, z
_SKY = "#0b0c0e"
_MARGIN, _SMALLEST_PX, _WIDEST_PX, _QUALITY = 0.3, 48, 340, 60
_HEAD, _OPEN_DEG = 0.16, 24.0  # of an arrow: length as a share of its own, half angle
Window = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One camera's cut-out: ``width`` × ``height`` px, and in its coordinates (SVG points) the ellipses and the answered axes."""

    name: str
    uri: str
    width: int
    height: int
    truth: str
    measured: str
    axes: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Strip:
    """One frame: its views, and the light's doings in the first of them as a picture of ``LIGHT_STATES``."""

    caption: str
    views: tuple[View, ...]
    light: str


def strip(dataset: Dataset, subject: RingSubject, answer: pd.Series, extras: Mapping[str, float], caption: str) -> Strip:
    """The strip of ``answer``'s frame. ``extras`` may hold the ellipses that the method measured."""
    frame = int(answer["frame"])
    poses, given = dataset.truth(frame).sensor_from_target, _given(answer)
    images = dataset.observation(frame).images
    views, light = [], ""
    for name, camera in subject.views.items():
        model, true = dataset.sensors[camera], poses[camera]
        lens, edge = model.intrinsics, model.intrinsics.project(true.apply(subject.circle.points_target(POINTS)))
        window = _window(edge, lens)
        camera_from_answer = None if given is None else true * poses[str(answer["sensor"])].inv() * given
        axes = () if camera_from_answer is None else _axes(subject, camera_from_answer, lens, window)
        pixels = fitted(shown(_cut(images[camera].pixels, window), model), _WIDEST_PX)
        size, measured = (window[2] - window[0], window[3] - window[1]), measured_ellipse(extras, name)
        drawn = "" if measured is None else _points(on_ellipse(measured, lens), window)
        views.append(View(name, data_uri(pixels, _QUALITY), *size, _points(edge, window), drawn, axes))
        light = light or _light(dataset, frame, camera, window)
    return Strip(caption, tuple(views), light)


def _given(answer: pd.Series) -> RigidTransform | None:
    """The answered pose, None without one or without its position."""
    numbers = answer.reindex([*QUATERNION, *TRANSLATION]).to_numpy(dtype=np.float64)
    if not np.isfinite(numbers).all():
        return None
    return RigidTransform.from_components(numbers[4:], Rotation.from_quat(numbers[:4], scalar_first=True))


def _window(edge_px: Floats, lens: Intrinsics) -> Window:
    """Left, top, right, bottom of a square around the ring, within the picture; the whole picture where the ring is not in it."""
    size = np.array([lens.width_px, lens.height_px])
    if not np.isfinite(edge_px).all():
        return 0, 0, lens.width_px, lens.height_px
    low, high = edge_px.min(axis=0), edge_px.max(axis=0)
    half = max(float((high - low).max()) * (0.5 + _MARGIN), _SMALLEST_PX / 2)
    first = np.clip(np.floor((low + high) / 2 - half), 0, size - 2).astype(int)
    last = np.clip(np.ceil((low + high) / 2 + half), first + 2, size).astype(int)
    return int(first[0]), int(first[1]), int(last[0]), int(last[1])


def _cut(pixels: NDArray[np.generic], window: Window) -> NDArray[np.generic]:
    left, top, right, bottom = window
    return pixels[top:bottom, left:right]


def _axes(subject: RingSubject, cam_from_target: RigidTransform, lens: Intrinsics, window: Window) -> tuple[tuple[str, str], ...]:
    """Colour and points of the ring's three axes at the answered pose, each as long as the radius; none behind the camera."""
    cam_from_ring = cam_from_target * subject.circle.target_from_feature
    ends = lens.project(cam_from_ring.apply(np.vstack([np.zeros(3), subject.circle.radius_m * np.eye(3)])))
    if not np.isfinite(ends).all():
        return ()
    return tuple((colour, _points(_arrow(ends[0], end), window)) for colour, end in zip(AXIS_COLOURS, ends[1:], strict=True))


def _arrow(foot: Floats, tip: Floats) -> Floats:
    """(5, 2) a line with a head, in one stroke."""
    shaft = (foot - tip) * _HEAD
    c, s = np.cos(np.radians(_OPEN_DEG)), np.sin(np.radians(_OPEN_DEG))
    return np.stack([foot, tip, tip + np.array([[c, -s], [s, c]]) @ shaft, tip, tip + np.array([[c, s], [-s, c]]) @ shaft])


def _points(pixels: Floats, window: Window) -> str:
    """SVG points: its (0, 0) is the corner of the first pixel, not its centre. Empty where one lies nowhere."""
    if not np.isfinite(pixels).all():
        return ""
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in pixels - np.array(window[:2]) + 0.5)


def _light(dataset: Dataset, frame: int, camera: str, window: Window) -> str:
    """The mask of a cut-out in the colours of ``LIGHT_STATES``; empty where the data set has no such layer."""
    mask = dataset.layers(frame, camera).get("mask")
    if mask is None:
        return ""
    cut = np.asarray(_cut(mask, window), dtype=np.uint32)
    step = max(1, -(-cut.shape[1] // _WIDEST_PX))  # whole pixels are left out, as mixed colours would be states that are not there
    cut = cut[::step, ::step]
    picture = np.full((*cut.shape, 3), _bgr(_SKY), dtype=np.uint8)
    for _, bit, colour in LIGHT_STATES:
        picture[(cut & bit) > 0] = _bgr(colour)
    return data_uri(picture, 101)


def _bgr(colour: str) -> tuple[int, int, int]:
    red, green, blue = (int(colour[place : place + 2], 16) for place in (1, 3, 5))
    return blue, green, red
