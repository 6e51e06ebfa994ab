"""A window that follows the target: empty space costs nothing.

One size serves a whole scenario, whatever frames are asked for, so kernels compile once and a frame's bytes do not depend on
its neighbours.
"""

import math

import numpy as np

from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.exr import Window
from scenes.scenario import Scenario, realize
from scenes.solids import bounding_points

_GRANULARITY_PX = 16
_PSF_SIGMAS = 5.0
_SPARE_PX = 3.0  # half a pixel of rounding, lens and motion within the exposure


def margin_px(camera: Camera) -> float:
    """How far around the target's outline the picture can hold its light."""
    return _SPARE_PX + _PSF_SIGMAS * camera.detector.psf_sigma_px


def window_size(scenario: Scenario, camera: Camera) -> tuple[int, int]:
    """Width and height in pixels that hold the target in every frame of ``scenario`` (at most the whole picture)."""
    points = bounding_points(scenario.target)
    boxes = np.array([_extent(scenario, camera, points, frame) for frame in range(scenario.frame_count)])
    widest = np.max(boxes[:, 2:] - boxes[:, :2], axis=0) + 2 * margin_px(camera) + 1
    grain = [_GRANULARITY_PX * math.ceil(edge / _GRANULARITY_PX) for edge in widest]
    return min(grain[0], camera.width_px), min(grain[1], camera.height_px)


def place_window(extent: Floats, size: tuple[int, int], camera: Camera) -> Window:
    """The window of ``size`` centred on ``extent`` = (left, top, right, bottom), kept inside the picture."""
    corner = [(extent[axis] + extent[axis + 2]) / 2 - (size[axis] - 1) / 2 for axis in (0, 1)]
    last = (camera.width_px - size[0], camera.height_px - size[1])
    x, y = (int(np.clip(round(value), 0, limit)) for value, limit in zip(corner, last))
    return Window(x, y, *size)


def target_extent(camera: Camera, points_cam: Floats) -> Floats:
    """Pixels (left, top, right, bottom) around points (n, 3) in the camera frame, cut at the picture's border.

    A target that reaches beside or behind the camera's plane is taken to fill the picture.
    """
    whole = np.array([0.0, 0.0, camera.width_px - 1.0, camera.height_px - 1.0])
    if np.any(points_cam[:, 2] <= 1e-3 * np.linalg.norm(points_cam, axis=1)):
        return whole
    pixels = camera.intrinsics.project(points_cam)
    box = np.concatenate([pixels.min(axis=0), pixels.max(axis=0)])
    return np.asarray(np.clip(box, np.tile(whole[:2], 2), np.tile(whole[2:], 2)))


def _extent(scenario: Scenario, camera: Camera, points_target: Floats, frame: int) -> Floats:
    chaser_from_target = realize(scenario, scenario.seed, frame).chaser_from_target
    cam_from_target = camera.mount.chaser_from_cam.inv() * chaser_from_target
    return target_extent(camera, cam_from_target.apply(points_target))
