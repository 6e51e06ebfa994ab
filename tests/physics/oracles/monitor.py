"""A plate shown on the paper's monitor before a camera without vices, and where its corners should be by OpenCV."""

from typing import Any

import cv2
import numpy as np

from oracles.studio import box, camera
from renderer.optics import blurred
from renderer.photograph import Photograph, Photographer
from scenes.arrays import Floats
from scenes.display import Display
from scenes.features import RectangleFeature
from scenes.intrinsics import Intrinsics
from scenes.scenario import Scenario, realize

F_PX = 8.0 / 3.75e-3
DISTANCE_M, PITCH_M = 0.61579, 0.264e-3
DOT_PX = F_PX * PITCH_M / DISTANCE_M
PLATE = RectangleFeature(name="plate", centre_m=(0.0005, 0, 0), length_m=10.0, width_m=3.0, free_standing=True)
SMOOTH = {"anti_aliasing": 256}
_MONITOR = {
    "dots": (800, 200),
    "pitch_m": PITCH_M,
    "field_deg": 30.0,
    "field_dots": 1250,
    "distance_m": DISTANCE_M,
    "radiance_w_m2_sr": 1.0,
    "relative_spectrum": {"wavelength_nm": [450, 650], "value": [1, 1], "zero_outside": True},
    "contrast": 1e6,
}


def plate(axis: str = "y", start_deg: float = 0.0, *, cam: dict[str, Any] | None = None, **display: Any) -> Scenario:
    """A plate of 10 m × 3 m, 1 mm thick, 100 m away, turning by 7° a frame; ``display``: changes of the monitor."""
    lens = camera(400, 120, F_PX, 0.02, detector_psf_sigma_px=0.5) | (cam or {})
    tree = {
        "frame_count": 12,
        "target": {"parts": [box((0.001, 10.0, 3.0))], "features": [PLATE.model_dump()]},
        "cameras": {"cam": lens},
        "lights": {"sun": {"type": "sun", "direction": (0.35, -0.5, -0.8)}},
        "motion": {"type": "axis-sweep", "axis": axis, "start_deg": start_deg, "rate_deg_s": 7.0, "range_m": 100.0},
        "display": _MONITOR | display,
    }
    return Scenario.model_validate(tree)


def with_changes(case: Scenario, **changes: Any) -> Scenario:
    """Another scenario, validated again."""
    return Scenario.model_validate(case.model_dump(mode="json") | changes)


def photographs(case: Scenario, frames: list[int]) -> list[Photograph]:
    """What the product makes of some frames."""
    photographer = Photographer(case, "cam")
    return [photographer.take(realize(case, 0, frame)) for frame in frames]


def screen_of(case: Scenario) -> Display:
    """The scenario's display."""
    assert case.display is not None
    return case.display


def lens_of(case: Scenario) -> Intrinsics:
    """The calibration of the camera."""
    return case.cameras["cam"].intrinsics


def through_lens(photo: Photograph) -> Floats:
    """The screen's radiance (height, width) as the lens blurs it, without noise."""
    return blurred(photo.layers["direct_diffuse"], 0.5).astype(np.float64)


def corners_cam(case: Scenario, frame: int) -> Floats:
    """The plate's corners (4, 3) before the camera."""
    return np.asarray(realize(case, 0, frame).chaser_from_target.apply(PLATE.corners_target))


def true_corners(case: Scenario, frame: int) -> Floats:
    """Where the camera would see the virtual target's corners (4, 2), by OpenCV."""
    return opencv(case, corners_cam(case, frame))


def opencv(case: Scenario, points: Floats, turn_rad: Any = (0.0, 0.0, 0.0), place: Any = (0.0, 0.0, 0.0)) -> Floats:
    """Pixels (n, 2) of points (n, 3) turned and moved before the camera."""
    lens = lens_of(case)
    matrix, bend = np.array(lens.matrix), np.array(lens.distortion)
    pixels, _ = cv2.projectPoints(np.ascontiguousarray(points), np.asarray(turn_rad), np.asarray(place), matrix, bend)
    return np.asarray(pixels[:, 0])


def corners_in_dots(case: Scenario, frame: int) -> Floats:
    """Where the plate's corners (4, 2) lie in the picture on the screen, in dots."""
    points, screen = corners_cam(case, frame), screen_of(case)
    return np.asarray(points[:, :2] / points[:, 2:] * screen.focal_dots + (np.array(screen.dots) - 1) / 2)


def corners_on_screen(case: Scenario, frame: int) -> Floats:
    """Where the camera sees the corners (4, 2) that the screen shows, however it stands, by OpenCV."""
    screen = screen_of(case)
    flat = (corners_in_dots(case, frame) - (np.array(screen.dots) - 1) / 2) * screen.pitch_m
    place = (*screen.offset_m, DISTANCE_M if screen.distance_m is None else screen.distance_m)
    return opencv(case, np.column_stack([flat, np.zeros(4)]), np.radians(screen.tilt_deg), place)
