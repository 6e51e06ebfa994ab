"""Lens distortion in pictures and truth, against OpenCV's model."""

import cv2
import numpy as np
import pytest
from oracles.raycaster import Triangles, cast, pixel_rays
from oracles.studio import Studio, box, camera, inside, scenario, still

from renderer.quality import Preset
from scenes.arrays import Floats
from scenes.intrinsics import Intrinsics

DISTORTION = (-0.28, 0.09, 1.5e-3, -8e-4, -0.01)
F_PX, WIDTH, HEIGHT = 300.0, 384, 288
TILE_M, DISTANCE_M = 0.3, 10.0
GRID_M = [(x, y) for x in (-5.4, -2.7, 0.0, 2.7, 5.4) for y in (-3.9, -1.3, 1.3, 3.9)]


@pytest.fixture(scope="module")
def studio() -> Studio:
    """A wide lens (65° × 51°) with a strong barrel before a tilted board of twenty small tiles."""
    tiles = [box((TILE_M, TILE_M, 1e-4), name=f"tile{i}", centre_m=(x, y, 0.0)) for i, (x, y) in enumerate(GRID_M)]
    cam = camera(WIDTH, HEIGHT, F_PX, distortion=DISTORTION, principal_point_px=(188.0, 147.5))
    return Studio(scenario(tiles, cam, still(DISTANCE_M, (6.0, -9.0, 4.0))), Preset(256, 0, denoise_indirect=False))


def test_rendered_tiles_lie_where_opencv_projects_them(studio: Studio):
    layers = studio.session.radiance(studio.view())
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    misses, bends = [], []
    for x, y in GRID_M:
        outline = _outline(x, y)
        expected = _centroid(_opencv(studio, outline))
        near = (np.abs(columns - expected[0]) < 12) & (np.abs(rows - expected[1]) < 12)
        light = layers["coverage"] * near
        measured = np.array([(light * columns).sum(), (light * rows).sum()]) / light.sum()
        misses.append(measured - expected)
        bends.append(np.linalg.norm(expected - _centroid(_opencv(studio, outline, distorted=False))))
    assert max(bends) > 20.0  # the lens does bend: without it the test would show little
    assert np.abs(misses).max() < 0.015  # a tile covers 9 × 9 pixels, sampled 256 times each: σ 0.004 px
    assert np.abs(np.mean(misses, axis=0)).max() < 0.005


def test_truth_layers_are_distorted_like_the_picture(studio: Studio):
    view = studio.view()
    geometry, light = studio.session.geometry(view), studio.session.radiance(view)
    triangles = Triangles.of(studio.scenario.target)
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH].astype(np.float64)
    pixels = np.stack([columns, rows], axis=-1).reshape(-1, 1, 2)
    steps = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-12)
    ideal = cv2.undistortPoints(pixels, _matrix(studio), np.array(DISTORTION), criteria=steps)
    sight = np.concatenate([ideal[:, 0], np.ones((len(ideal), 1))], axis=1)
    sight /= np.linalg.norm(sight, axis=1, keepdims=True)
    target_from_cam = studio.cam_from_target().inv()
    directions = target_from_cam.rotation.apply(sight)
    hits = cast(triangles, np.broadcast_to(target_from_cam.translation, directions.shape), directions)
    part_id = np.where(hits.valid, triangles.part_id[hits.triangle], 0).reshape(HEIGHT, WIDTH)
    assert len(np.unique(part_id)) == 21
    assert (geometry["part_id"] != part_id).sum() <= 8  # of 1500 pixels on tiles, those whose centre grazes a border
    both = (part_id > 0) & (geometry["part_id"] > 0)
    z = (hits.distance * sight[:, 2]).reshape(HEIGHT, WIDTH)
    assert np.abs(geometry["z_m"][both] / z[both] - 1).max() < 1e-5
    assert (light["coverage"][inside(part_id > 0, 2)] == 1).all()
    assert (light["coverage"][inside(part_id == 0, 2)] == 0).all()


def test_without_its_distortion_the_same_lens_sees_other_things(studio: Studio):
    straight = Intrinsics(WIDTH, HEIGHT, F_PX, F_PX, 188.0, 147.5)
    origins, directions = pixel_rays(straight, studio.cam_from_target(), studio.window)
    hits = cast(Triangles.of(studio.scenario.target), origins, directions)
    seen = studio.session.geometry(studio.view())["part_id"].ravel() > 0
    assert (seen & hits.valid).sum() < 0.7 * seen.sum()


def _matrix(studio: Studio) -> Floats:
    return np.array(studio.camera.intrinsics.matrix)


def _outline(x: float, y: float) -> Floats:
    """Points around the tile's front, dense enough that its image may have curved sides."""
    steps = np.linspace(-0.5, 0.5, 20, endpoint=False)
    half = np.full_like(steps, 0.5)
    around = np.concatenate(
        [
            np.column_stack([steps, -half]),
            np.column_stack([half, steps]),
            np.column_stack([-steps, half]),
            np.column_stack([-half, -steps]),
        ]
    )
    return np.column_stack([around * TILE_M + (x, y), np.full(len(around), -5e-5)])


def _opencv(studio: Studio, points_target: Floats, *, distorted: bool = True) -> Floats:
    pose = studio.cam_from_target()
    distortion = np.array(DISTORTION) if distorted else np.zeros(5)
    pixels, _ = cv2.projectPoints(points_target, pose.rotation.as_rotvec(), pose.translation, _matrix(studio), distortion)
    return pixels[:, 0]


def _centroid(polygon: Floats) -> Floats:
    """Centre of the area within a polygon (n, 2)."""
    x, y = polygon.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    return np.array([((x + np.roll(x, -1)) * cross).sum(), ((y + np.roll(y, -1)) * cross).sum()]) / (3 * cross.sum())
