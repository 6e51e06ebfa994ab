"""Outlines lie where the pixels are: an oracle that asks of each pixel's ray what it meets, and hand-made corners."""

import re

import cv2
import numpy as np
import pytest
from matplotlib.path import Path
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.gallery_outlines import closed, detected, outlined, silhouette, stroke
from benchmark.gallery_window import Window, around
from scenes.features import CircleFeature, RectangleFeature
from scenes.intrinsics import Intrinsics
from scenes.solids import Solid, solids
from scenes.target import Target

LENS = Intrinsics(320, 240, 300.0, 310.0, 155.0, 121.0, (-0.12, 0.02, 0.001, -0.0005, 0.0))
_PAINT = {"type": "paint", "reflectance": 0.5, "source": "made up"}
TARGET = Target.model_validate(
    {
        "type": "assembly",
        "parts": [
            {"name": "body", "shape": {"type": "box", "size_m": [2.0, 1.6, 1.2]}, "material": _PAINT},
        ],
    }
)
POSE = RigidTransform.from_components([-0.6, 0.2, 9.0], Rotation.from_euler("xyz", [20, 35, 50], degrees=True))
WINDOW = Window(40, 30, 300, 220)


def _polygons(path: str) -> list[np.ndarray]:
    return [np.array([one.split(",") for one in part.split()], dtype=float) for part in re.findall(r"M([^MZ]*)", path)]


def _seen(parts: tuple[Solid, ...], pose: RigidTransform) -> np.ndarray:
    """(height, width) whether the ray through a pixel's centre meets a triangle: Möller and Trumbore's test, part by part."""
    across, down = np.meshgrid(np.arange(LENS.width_px), np.arange(LENS.height_px))
    rays = LENS.rays(np.stack([across, down], axis=-1)).reshape(-1, 3)
    hit = np.zeros(len(rays), dtype=bool)
    for part in parts:
        for a, b, c in pose.apply(part.vertices_target)[part.faces]:
            u_axis, v_axis = b - a, c - a
            normal = np.cross(u_axis, v_axis)
            depth = (a @ normal) / (rays @ normal)
            inside = depth[:, None] * rays - a
            weights = np.linalg.lstsq(np.stack([u_axis, v_axis], axis=1), inside.T, rcond=None)[0]
            hit |= (depth > 0) & (weights >= 0).all(axis=0) & (weights.sum(axis=0) <= 1)
    return hit.reshape(LENS.height_px, LENS.width_px)


def test_the_silhouette_runs_along_the_border_of_the_part_mask() -> None:
    shape = solids(TARGET)
    mask = WINDOW.cut(_seen(shape, POSE)).astype(np.uint8)
    border = cv2.morphologyEx(mask, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8))
    away = cv2.distanceTransform(1 - border, cv2.DIST_L2, 5)
    (polygon,) = _polygons(silhouette(shape, POSE, LENS, WINDOW))
    ends = np.stack([polygon, np.roll(polygon, -1, axis=0)])
    points = np.concatenate([ends[0] * (1 - t) + ends[1] * t for t in np.linspace(0, 1, 9)]) - 0.5
    columns, rows = np.round(points).astype(int).T
    assert away[rows, columns].max() <= 1.5
    across, down = np.meshgrid(np.arange(WINDOW.width) + 0.5, np.arange(WINDOW.height) + 0.5)
    centres = np.stack([across.ravel(), down.ravel()], axis=1)

    def agreement(outline: np.ndarray) -> float:
        inside = Path(outline).contains_points(centres).reshape(mask.shape)
        return float((inside & (mask > 0)).sum() / (inside | (mask > 0)).sum())

    assert agreement(polygon) > 0.985
    assert agreement(polygon - 0.5) < agreement(polygon) - 0.004  # the control: half a pixel beside is seen


def test_a_silhouette_has_holes_and_no_lines_where_the_window_cuts() -> None:
    ring = Target.model_validate(
        {
            "type": "assembly",
            "parts": [
                {"name": str(n), "shape": {"type": "box", "size_m": size}, "material": _PAINT, "centre_m": centre}
                for n, (size, centre) in enumerate(
                    [
                        ([4, 0.4, 0.1], [0, 1.8, 0]),
                        ([4, 0.4, 0.1], [0, -1.8, 0]),
                        ([0.4, 4, 0.1], [1.8, 0, 0]),
                        ([0.4, 4, 0.1], [-1.8, 0, 0]),
                    ]
                )
            ],
        }
    )
    pose = RigidTransform.from_translation([0, 0, 8.0])
    assert len(_polygons(silhouette(solids(ring), pose, LENS, WINDOW))) == 2
    cut = _polygons(silhouette(solids(ring), pose, LENS, Window(150, 40, 290, 200)))
    assert min(one[:, 0].min() for one in cut) < 0  # the line along the window's edge lies outside of it


def test_the_inside_of_an_open_surface_and_what_is_behind_the_camera_have_no_outline() -> None:
    square = np.array([(-1.0, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    faces = np.array([(0, 1, 2), (0, 2, 3)])
    sheet = (Solid("sheet", square, faces),)
    towards = RigidTransform.from_components([0, 0, 8.0], Rotation.from_euler("x", 180, degrees=True))
    assert silhouette(sheet, towards, LENS, WINDOW)
    assert silhouette(sheet, RigidTransform.from_translation([0, 0, 8.0]), LENS, WINDOW) == ""
    assert silhouette(sheet, RigidTransform.from_components([0, 0, -8.0], towards.rotation), LENS, WINDOW) == ""
    assert silhouette((), towards, LENS, WINDOW) == ""


def test_features_are_outlined_with_the_first_pixels_corner_as_the_origin() -> None:
    rectangle = RectangleFeature(name="panel", centre_m=(0.1, 0.2, 0.0), length_m=2.0, width_m=1.0)
    (found,) = _polygons(outlined(rectangle, POSE, LENS, WINDOW))
    expected = LENS.project(POSE.apply(rectangle.corners_target))[[0, 1, 3, 2]] - [WINDOW.left, WINDOW.top] + 0.5
    np.testing.assert_allclose(found, expected, atol=0.051)
    ring = CircleFeature(type="circle", name="ring", centre_m=(0, 0, 0.6), radius_m=0.5)
    circle, *axes = _polygons(outlined(ring, POSE, LENS, WINDOW))
    assert len(circle) == 72
    assert [len(axis) for axis in axes] == [2, 2]
    np.testing.assert_allclose(axes[0][1], circle[0], atol=0.11)  # X points to where the circle begins
    away = RigidTransform.from_translation([0, 0, -5.0])
    assert outlined(rectangle, away, LENS, WINDOW) == ""
    assert outlined(ring, away, LENS, WINDOW) == ""


def test_detections_are_drawn_through_the_lens_and_an_outside_method_needs_none() -> None:
    assert detected({}, "left", LENS, WINDOW) == ""
    assert detected({"p1p2_x0_px": 100.0, "left_x_px": 3.0}, "left", LENS, WINDOW) == ""
    edge = {"p1p2_x0_px": 60.0, "p1p2_y0_px": 70.0, "p1p2_x1_px": 250.0, "p1p2_y1_px": 180.0}
    (line,) = _polygons(detected(edge, "", LENS, WINDOW))
    ideal = np.array([[60.0, 70.0], [250.0, 180.0]])
    bent = LENS.pixels_from_normalised((ideal - [LENS.cx_px, LENS.cy_px]) / [LENS.fx_px, LENS.fy_px])
    np.testing.assert_allclose(line, bent - [40, 30] + 0.5, atol=0.051)
    corners = {
        f"p{n + 1}_{axis}_px": value
        for n, point in enumerate([(80, 90), (200, 90), (80, 160), (200, 160)])
        for axis, value in zip("xy", point)
    }
    (quad,) = _polygons(detected(corners, "", LENS, WINDOW))
    assert len(quad) == 4
    assert cv2.isContourConvex(quad.astype(np.float32))  # around, not in Z-order
    ellipse = {"left_x_px": 150.0, "left_y_px": 120.0, "left_a_px": 40.0, "left_b_px": 20.0, "left_theta_rad": 0.5}
    assert len(_polygons(detected(ellipse, "left", LENS, WINDOW))[0]) == 72
    assert detected(ellipse, "right", LENS, WINDOW) == ""


@pytest.mark.parametrize("points", [[[np.nan, 0.0]], [[1e9, 0.0]], np.empty((0, 2))])
def test_a_path_that_cannot_be_drawn_is_empty(points: list[list[float]]) -> None:
    assert stroke(np.array(points)) == ""
    assert closed(np.array(points)) == ""


def test_a_window_holds_its_points_and_is_the_whole_picture_where_they_are_not_in_it() -> None:
    points = np.array([[100.0, 80.0], [180.0, 120.0]])
    window = around(points, LENS)
    assert (points > [window.left, window.top]).all()
    assert (points < [window.right - 1, window.bottom - 1]).all()
    for outside in (np.full((2, 2), np.nan), points - 900.0):
        assert around(outside, LENS) == Window(0, 0, 320, 240)
