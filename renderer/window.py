"""A window that follows the target: empty space costs nothing.

One size serves a whole scenario, whatever frames are asked for, so kernels compile once and a frame's bytes do not depend on
its neighbours.
"""

import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from renderer.sensor import exposure_instants_s, longest_exposure_s
from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.errors import UsageError
from scenes.exr import Window
from scenes.intrinsics import Intrinsics
from scenes.scenario import Scenario
from scenes.solids import bounding_points

_GRANULARITY_PX = 16
_PSF_SIGMAS = 5.0
_SPARE_PX = 3.0  # rounding of the window's place, and the outermost tail of the lens
_STILL_PX = 0.01  # motion within one exposure below which a picture counts as sharp
_OUTLINE_STEPS = 33
_LARGEST_TURN_RAD = 1.0  # within one exposure; the kernel turns by a series


@dataclass(frozen=True, slots=True)
class Survey:
    """What a look at all frames of a scenario says: ``size`` (width, height) of the window; whether anything ``moves``."""

    size: tuple[int, int]
    moves: bool


def survey(scenario: Scenario, camera: Camera) -> Survey:
    """The window that holds the target in every frame from opening to closing of the shutter.

    It reaches over the picture's border by what the lens can blur back in, at most. ``moves`` says whether the target moves
    visibly within the longest exposure of any frame.
    """
    points = bounding_points(scenario.target)
    lens, cam_from_chaser = camera.intrinsics, camera.mount.chaser_from_cam.inv()
    widest, fastest = np.zeros(2), 0.0
    for frame in range(scenario.frame_count):
        opened, middle, closed = (cam_from_chaser.apply(swept) for swept in _swept(scenario, camera, frame, points))
        box = target_extent(camera, np.concatenate([opened, middle, closed]))
        widest = np.maximum(widest, box[2:] - box[:2])
        seen = [lens.project(points_cam) for points_cam in (opened, middle, closed)]
        moved = np.stack([seen[1] - seen[0], seen[2] - seen[1]])  # half a turn each way may end where it began
        fastest = float(np.nanmax(np.abs(moved), initial=fastest))
    grain = [_GRANULARITY_PX * math.ceil(edge / _GRANULARITY_PX) for edge in widest + 2 * margin_px(camera) + 1]
    over = 2 * _border_px(camera)
    return Survey((min(grain[0], camera.width_px + over), min(grain[1], camera.height_px + over)), fastest > _STILL_PX)


def whole_picture(camera: Camera) -> Survey:
    """The window that holds all of the picture, and beside it what the lens can blur in."""
    over = 2 * _border_px(camera)
    return Survey((camera.width_px + over, camera.height_px + over), moves=False)


def refuse_fast_spin(scenario: Scenario) -> None:
    """Raises ``UsageError`` where the target turns further within one exposure than the motion blur follows."""
    instants = (frame / scenario.rate_hz for frame in range(scenario.frame_count))
    rate_rad_s = max(math.hypot(*scenario.trajectory.omega_target_rad_s(instant_s, scenario.seed)) for instant_s in instants)
    for name, camera in scenario.sensors.items():
        turn_rad = rate_rad_s * longest_exposure_s(camera)
        if turn_rad > _LARGEST_TURN_RAD:
            raise UsageError(
                f"{scenario.field_of(name)}.exposure: the target turns by {np.degrees(turn_rad):.0f} deg within the longest "
                f"exposure of {longest_exposure_s(camera):g} s, at most {np.degrees(_LARGEST_TURN_RAD):.0f} deg are rendered; "
                "shorten it"
            )


def margin_px(camera: Camera) -> float:
    """How far around the target's outline the picture can hold its light."""
    return _SPARE_PX + _PSF_SIGMAS * camera.detector.psf_sigma_px


def place_window(extent: Floats, size: tuple[int, int], camera: Camera) -> Window:
    """The window of ``size`` centred on ``extent`` = (left, top, right, bottom), kept within reach of the picture."""
    border = _border_px(camera)
    corner = [(extent[axis] + extent[axis + 2]) / 2 - (size[axis] - 1) / 2 for axis in (0, 1)]
    last = (camera.width_px + border - size[0], camera.height_px + border - size[1])
    x, y = (int(np.clip(round(value), -border, limit)) for value, limit in zip(corner, last))
    return Window(x, y, *size)


def inside(window: Window, camera: Camera) -> Window:
    """The part of ``window`` that lies in the picture."""
    left, top = max(window.x_px, 0), max(window.y_px, 0)
    right = min(window.x_px + window.width_px, camera.width_px)
    bottom = min(window.y_px + window.height_px, camera.height_px)
    return Window(left, top, right - left, bottom - top)


def _border_px(camera: Camera) -> int:
    """How far beside the picture light can stand that the lens blurs into it."""
    return math.ceil(_PSF_SIGMAS * camera.detector.psf_sigma_px)


def target_extent(camera: Camera, points_cam: Floats) -> Floats:
    """Pixels (left, top, right, bottom) around points (n, 3) in the camera frame, cut where the lens no longer reaches.

    A target that reaches beside or behind the camera's plane, or out of the lens's field, is taken to fill the picture.
    """
    border = _border_px(camera)
    whole = np.array([-border, -border, camera.width_px - 1.0 + border, camera.height_px - 1.0 + border])
    if np.any(points_cam[:, 2] <= 1e-3 * np.linalg.norm(points_cam, axis=1)):
        return whole
    pixels = outline_px(camera.intrinsics, points_cam[:, :2] / points_cam[:, 2:])
    if np.isnan(pixels).any():
        return whole
    box = np.concatenate([pixels.min(axis=0), pixels.max(axis=0)])
    return np.asarray(np.clip(box, np.tile(whole[:2], 2), np.tile(whole[2:], 2)))


def outline_px(intrinsics: Intrinsics, normalised: Floats) -> Floats:
    """Pixels (m, 2) along the edges of the box around ideal normalised points (n, 2).

    A distorted lens bends straight edges outwards past their ends, so corners alone would not enclose what lies between.
    """
    low, high = normalised.min(axis=0), normalised.max(axis=0)
    steps = np.linspace(0.0, 1.0, _OUTLINE_STEPS if intrinsics.is_distorted else 2)
    edges = [np.column_stack([steps, np.full_like(steps, end)]) for end in (0.0, 1.0)]
    return intrinsics.pixels_from_normalised(low + np.concatenate([*edges, *(edge[:, ::-1] for edge in edges)]) * (high - low))


def _swept(scenario: Scenario, camera: Camera, frame: int, points_target: Floats) -> list[Floats]:
    """``points_target`` in chaser axes when the shutter opens, halfway, and when it closes, at its longest."""
    pose_at = partial(scenario.trajectory.chaser_from_target, frame=frame, seed=scenario.seed)
    instants = exposure_instants_s(frame / scenario.rate_hz, longest_exposure_s(camera))
    return [pose_at(instant_s).apply(points_target) for instant_s in instants]
