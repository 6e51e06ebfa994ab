"""The picture behind a frame, cut out around the feature, with the true rectangle and the answered one drawn over it."""

import base64
from dataclasses import dataclass
from typing import Any, TypeVar

import cv2
import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.predictions import QUATERNION, TRANSLATION
from scenes.arrays import Floats
from scenes.dataset import Dataset
from scenes.features import CircleFeature, Feature, RectangleFeature
from scenes.recording import SensorModel

CYCLIC = [0, 1, 3, 2]  # corners P1 … P4 lie in Z-order
_MARGIN, _SMALLEST_PX, _WIDEST_PX, _GAMMA = 0.35, 120, 900, 2.2


Number = TypeVar("Number", np.uint8, np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A cut-out as a PNG data URI of ``width`` × ``height`` px, with polygons in its pixel coordinates (SVG points)."""

    uri: str
    width: int
    height: int
    truth: str
    answer: str
    caption: str
    is_failure: bool


def picture(dataset: Dataset, feature: RectangleFeature, answer: pd.Series, caption: str) -> Picture:
    """The picture of ``answer``'s frame and sensor. An answer without a position is drawn at the true one."""
    frame, sensor = int(answer["frame"]), str(answer["sensor"])
    model, pose = dataset.sensors[sensor], dataset.truth(frame).sensor_from_target[sensor]
    true = model.intrinsics.project(pose.apply(feature.corners_target))
    left, top, right, bottom = _window(true, model)
    pixels = shown(dataset.observation(frame).images[sensor].pixels[top:bottom, left:right], model)
    offset = np.array([left - 0.5, top - 0.5])  # SVG's (0, 0) is the corner of the first pixel, not its centre
    answered = answer["outcome"] == "ok"
    guess = model.intrinsics.project(_answered_corners(answer, pose, feature)) if answered else np.empty((0, 2))
    return Picture(
        uri=data_uri(pixels),
        width=right - left,
        height=bottom - top,
        truth=_points(true - offset),
        answer=_points(guess - offset) if answered else "",
        caption=caption,
        is_failure=not answered,
    )


def glimpse(dataset: Dataset, frame: int, caption: str) -> Picture:
    """The first sensor's picture of ``frame`` as the methods see it, cut out around all features of the target."""
    sensor = next(iter(dataset.sensors))
    model, pose = dataset.sensors[sensor], dataset.truth(frame).sensor_from_target[sensor]
    corners = [model.intrinsics.project(pose.apply(outline(feature))) for feature in dataset.features]
    whole = np.array([[0.0, 0.0], [model.intrinsics.width_px - 1, model.intrinsics.height_px - 1]])
    left, top, right, bottom = _window(np.vstack(corners) if corners else whole, model)
    pixels = shown(dataset.observation(frame).images[sensor].pixels[top:bottom, left:right], model)
    uri = data_uri(fitted(pixels, _WIDEST_PX))
    return Picture(uri, right - left, bottom - top, truth="", answer="", caption=caption, is_failure=False)


def outline(feature: Feature) -> Floats:
    """(n, 3) points of the target frame between which a feature lies: its corners, its edge, or a marker's centre."""
    if isinstance(feature, RectangleFeature):
        return feature.corners_target
    return feature.points_target(72) if isinstance(feature, CircleFeature) else np.array([feature.centre_m])


def _answered_corners(answer: pd.Series, pose: RigidTransform, feature: RectangleFeature) -> Floats:
    """Corners in the sensor frame at the answered attitude; without a position, about the feature's true centre."""
    rotation = Rotation.from_quat(answer[list(QUATERNION)].to_numpy(dtype=np.float64), scalar_first=True)
    position = answer[list(TRANSLATION)].to_numpy(dtype=np.float64)
    if not np.isfinite(position).all():
        position = pose.apply(feature.centre_m) - rotation.apply(feature.centre_m)
    return np.asarray(RigidTransform.from_components(position, rotation).apply(feature.corners_target))


def _window(corners: Floats, model: SensorModel) -> tuple[int, int, int, int]:
    """Left, top, right, bottom of the cut-out: the corners with a margin, within the picture."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    half = np.maximum((high - low) * (0.5 + _MARGIN), _SMALLEST_PX / 2)
    half[1] = max(half[1], half[0] / 4)
    half[0] = max(half[0], half[1] * 2)
    size = np.array([model.intrinsics.width_px, model.intrinsics.height_px])
    first = np.clip(np.floor((low + high) / 2 - half), 0, size - 2).astype(int)
    last = np.clip(np.ceil((low + high) / 2 + half), first + 2, size).astype(int)
    return int(first[0]), int(first[1]), int(last[0]), int(last[1])


def shown(pixels: NDArray[Any], model: SensorModel) -> NDArray[np.uint8]:
    """DN as 8-bit grey for the screen: black level taken off, full scale white, gamma 2.2 so that shadows can be seen."""
    linear = (pixels.astype(np.float64) - model.black_dn) / (model.white_dn - model.black_dn)
    return np.asarray(np.round(255 * np.clip(linear, 0, 1) ** (1 / _GAMMA)), dtype=np.uint8)


def fitted(pixels: NDArray[Number], widest_px: int) -> NDArray[Number]:
    """The picture, made smaller where it is wider than ``widest_px``: means over areas."""
    height, width = pixels.shape[:2]
    if width <= widest_px:
        return pixels
    size = widest_px, max(1, round(height * widest_px / width))
    return np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), dtype=pixels.dtype)


def data_uri(pixels: NDArray[np.uint8], quality: int = 70) -> str:
    """A picture (grey, or blue-green-red) as WebP in a link; a ``quality`` above 100 is without loss."""
    _, data = cv2.imencode(".webp", pixels, [cv2.IMWRITE_WEBP_QUALITY, quality])  # PNG stores the noise at three times the size
    return "data:image/webp;base64," + base64.b64encode(data.tobytes()).decode()


def _points(corners: Floats) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in corners[CYCLIC])


def bgr(colour: str) -> tuple[int, int, int]:
    """#rrggbb as OpenCV has it."""
    red, green, blue = (int(colour[place : place + 2], 16) for place in (1, 3, 5))
    return blue, green, red
