"""Where things are in the picture: depth, sizes, corners and part numbers against analytic geometry."""

import numpy as np
import pytest
from oracles.edges import fit_corners
from oracles.raycaster import Triangles, cast, pixel_rays
from oracles.studio import Studio, box, camera, inside, scenario, still
from scipy.spatial.transform import Rotation

from renderer.quality import Preset
from scenes.arrays import Floats
from scenes.features import RectangleFeature
from scenes.scenario import Scenario

GEOMETRY_ONLY = Preset(1, 0, denoise_indirect=False)


def test_depth_of_a_tilted_thin_panel_is_exact_up_to_the_picture_corner():
    # 60° × 47° of field: at the corner the ray is 1.2 times as long as z, so a ray distance would be far off.
    panel = box((80.0, 80.0, 0.01))
    studio = Studio(scenario([panel], camera(320, 240, f_px=277.0), still(12.0, (35.0, -28.0, 15.0))), GEOMETRY_ONLY)
    layers = studio.session.geometry(studio.view())
    assert (layers["part_id"] == 1).all()
    tilt = Rotation.from_rotvec((35.0, -28.0, 15.0), degrees=True)
    normal = tilt.apply([0.0, 0.0, 1.0])
    front = np.array([0.0, 0.0, 12.0]) - 0.005 * normal * np.sign(normal[2])
    rows, columns = np.mgrid[0:240, 0:320]
    sight = np.stack([(columns - 159.5) / 277.0, (rows - 119.5) / 277.0, np.ones_like(rows)], axis=-1)
    z = (front @ normal) / (sight @ normal)
    error = np.abs(layers["z_m"] / z - 1)
    assert error[[0, 0, -1, -1], [0, -1, 0, -1]].max() < 1e-6
    assert error.max() < 1e-6  # measured 2e-7, float32's own step; the promise is 1e-5
    seen = np.stack([layers[f"normal.{axis}"] for axis in "xyz"], axis=-1)
    assert np.abs(seen + normal * np.sign(normal[2])).max() < 1e-6


@pytest.mark.parametrize(("feature", "size_px"), [("wing", (213.33, 64.0)), ("face", (64.97, 64.97)), ("span", (512.0, 64.0))])
def test_sizes_at_zero_angle_are_the_papers(in_plane_studio: Studio, feature: str, size_px: tuple[float, float]):
    studio = in_plane_studio
    rectangle = _feature(studio.scenario, feature)
    truth = _project(studio, rectangle, 420)
    # The wing's front lies 0.03 m before the plane of the paper's sizes.
    scale = 1.0 if feature == "face" else 100.0 / (100.0 - 0.03)
    assert _size_px(truth) == pytest.approx(np.array(size_px) * scale, abs=0.011)
    view = studio.view(420)
    picture = studio.picture(studio.session.radiance(view), view.window)
    assert _size_px(fit_corners(picture, truth)) == pytest.approx(_size_px(truth), abs=0.03 if feature != "wing" else 0.06)


@pytest.mark.parametrize("case", ["in_plane", "out_of_plane"])
def test_true_corners_lie_on_the_rendered_edges(case: str, request: pytest.FixtureRequest):
    studio: Studio = request.getfixturevalue(f"{case}_studio")
    misses = np.array([miss for frame in range(20, 721, 50) for miss in _misses(studio, frame)])
    assert len(misses) >= 50
    miss_px = np.linalg.norm(misses, axis=1)
    assert np.median(miss_px) < 0.006  # measured 0.003 in both; the promise is 0.06
    # One corner in seven is off by 0.05 to 0.17 px whatever the seed and the number of samples: light of another part beside it.
    assert np.percentile(miss_px, 80) < 0.02
    assert miss_px.max() < 0.25
    assert np.abs(np.median(misses, axis=0)).max() < 0.005  # a half-pixel convention error would be 0.5


def _misses(studio: Studio, frame: int) -> list[Floats]:
    """Measured minus true corner, in pixels, wherever both edges of the corner can be seen for what they are."""
    view = studio.view(frame)
    picture = studio.picture(studio.session.radiance(view), view.window)
    misses = []
    for name in ("face", "wing", "span"):
        feature = _feature(studio.scenario, name)
        truth = _project(studio, feature, frame)
        clean = _clean_edges(studio, feature, frame)
        fitted = fit_corners(picture, truth)
        for corner, edges in enumerate([("bottom", "left"), ("bottom", "right"), ("top", "left"), ("top", "right")]):
            if all(clean[edge] for edge in edges) and np.isfinite(fitted[corner]).all():
                misses.append(fitted[corner] - truth[corner])
    return misses


def _clean_edges(studio: Studio, feature: RectangleFeature, frame: int) -> dict[str, bool]:
    """Edges with nothing bright right behind them and nothing before them.

    Behind an edge lies another side of the same box: where it is lit and turned to the camera, the silhouette is that side's.
    """
    scene = studio.scene(frame)
    camera_target = studio.cam_from_target(frame).inv().translation
    p1, p2, p3, p4 = feature.corners_target
    ends = {"bottom": (p1, p2), "top": (p3, p4), "left": (p1, p3), "right": (p2, p4)}
    centre = np.asarray(feature.centre_m)
    clean = {}
    for name, (start, end) in ends.items():
        middle = (start + end) / 2
        aside = (middle - centre) / np.linalg.norm(middle - centre)
        shows = aside @ (camera_target - middle) > 0 and aside @ scene.lights[0].direction_target > 0
        inwards = 0.05 * (centre - middle) / np.linalg.norm(centre - middle)
        clean[name] = not shows and all(_is_free(studio, start + step * inwards, end + step * inwards, frame) for step in (1, -6))
    return clean


def _is_free(studio: Studio, start: Floats, end: Floats, frame: int) -> bool:
    """Whether nothing stands between the camera and a line on the target."""
    camera_target = studio.cam_from_target(frame).inv().translation
    points = start + np.linspace(0.02, 0.98, 25)[:, None] * (end - start)
    away = points - camera_target
    distance = np.linalg.norm(away, axis=1)
    hits = cast(Triangles.of(studio.scenario.target), np.broadcast_to(camera_target, away.shape), away / distance[:, None])
    return bool(np.all(hits.distance > distance - 0.2))


def _feature(case: Scenario, name: str) -> RectangleFeature:
    return next(feature for feature in case.target.features if feature.name == name)


def _project(studio: Studio, feature: RectangleFeature, frame: int) -> Floats:
    return studio.camera.intrinsics.project(studio.cam_from_target(frame).apply(feature.corners_target))


def _size_px(corners_px: Floats) -> Floats:
    p1, p2, p3, p4 = corners_px
    return np.array([np.linalg.norm(p2 - p1) + np.linalg.norm(p4 - p3), np.linalg.norm(p3 - p1) + np.linalg.norm(p4 - p2)]) / 2


@pytest.mark.parametrize(("case", "frame"), [("in_plane", 100), ("in_plane", 790), ("out_of_plane", 10), ("out_of_plane", 600)])
def test_part_numbers_and_depth_agree_with_a_ray_caster_of_our_own(case: str, frame: int, request: pytest.FixtureRequest):
    studio: Studio = request.getfixturevalue(f"{case}_studio")
    view = studio.view(frame)
    layers = studio.session.geometry(view)
    triangles = Triangles.of(studio.scenario.target)
    origins, directions = pixel_rays(studio.camera.intrinsics, studio.cam_from_target(frame), view.window)
    hits = cast(triangles, origins, directions)
    part_id = np.where(hits.valid, triangles.part_id[hits.triangle], 0).reshape(layers["part_id"].shape)
    assert {0, 1, 2, 4} <= set(np.unique(part_id))  # the cube may hide a yoke
    differs = layers["part_id"] != part_id
    assert differs.mean() < 1e-4  # a ray that grazes an edge may go either way in float32
    assert not (differs & _uniform(part_id)).any()
    z = hits.distance.reshape(part_id.shape) * studio.camera.intrinsics.rays(np.stack(_pixels(view.window), -1))[..., 2]
    both = (part_id > 0) & (layers["part_id"] == part_id)
    assert np.abs(layers["z_m"][both] / z[both] - 1).max() < 1e-5
    assert (layers["z_m"][layers["part_id"] == 0] == 0).all()


def _pixels(window) -> list[Floats]:
    rows, columns = np.mgrid[window.slices]
    return [columns.astype(float), rows.astype(float)]


def _uniform(ids: Floats) -> Floats:
    """Pixels whose eight neighbours have the same number."""
    return np.logical_or.reduce([inside(ids == number) for number in np.unique(ids)])
