"""How much of the target the picture holds, against areas worked out by hand and by a ray caster."""

import numpy as np
import pytest
from oracles.raycaster import Triangles, cast
from oracles.studio import Studio, box, camera, scenario, still

from renderer.photograph import Photographer
from renderer.quality import Preset
from scenes.scenario import realize

NO_LIGHT = Preset(1, 0, denoise_indirect=False)


def _fraction(x_m: float, y_m: float = 0.0, **changes) -> float:
    """Visible share of a 2 × 2 m plate at 10 m before a camera whose picture ends at x = ±2.4 m and y = ±1.6 m there."""
    motion = still(10.0) | {"position_m": (x_m, y_m, 10.0)}
    studio = Studio(scenario([box((2.0, 2.0, 1e-4))], camera(96, 64, 200.0, **changes), motion), NO_LIGHT)
    points = studio.cam_from_target()
    from scenes.solids import bounding_points

    return studio.session.visible_fraction(points, bounding_points(studio.scenario.target), studio.camera.intrinsics)


@pytest.mark.parametrize(
    ("x_m", "y_m", "fraction"),
    [
        (0.0, 0.0, 1.0),
        (1.3, 0.5, 1.0),
        (2.4, 0.0, 0.5),
        (-2.4, 0.0, 0.5),
        (2.9, 0.0, 0.25),
        (2.4, 1.6, 0.25),
        (0.0, -2.1, 0.25),
        (5.0, 0.0, 0.0),
    ],
)
def test_a_plate_at_the_border_shows_the_part_that_is_inside(x_m: float, y_m: float, fraction: float):
    assert _fraction(x_m, y_m) == pytest.approx(fraction, abs=0.006)


def test_a_target_reaching_behind_the_camera_has_none():
    case = scenario([box((2.0, 2.0, 30.0))], camera(96, 64, 200.0), still(10.0), quality="draft")
    photo = Photographer(case, "cam").take(realize(case, 0, 0))
    assert np.isnan(photo.truth["visible_fraction"])


def test_a_folding_lens_counts_nothing_twice():
    # Beyond its field the distortion polynomial would fold far points back into the picture.
    assert _fraction(2.4, distortion=(-0.3, 0.0, 0.0, 0.0, 0.0)) == pytest.approx(0.5, abs=0.03)
    assert _fraction(30.0, distortion=(-0.3, 0.0, 0.0, 0.0, 0.0)) == 0.0


def test_a_crooked_body_under_a_distorted_lens_agrees_with_a_ray_caster_of_our_own():
    body = [box((3.0, 1.0, 1.0)), box((0.3, 4.0, 0.5), name="mast", centre_m=(1.2, 0.0, 0.4))]
    motion = still(8.0, (20.0, 35.0, 15.0)) | {"position_m": (2.5, 1.0, 8.0)}
    cam = camera(96, 64, 150.0, distortion=(-0.2, 0.05, 1e-3, -1e-3, 0.0))
    case = scenario(body, cam, motion, quality="draft")
    photo = Photographer(case, "cam").take(realize(case, 0, 0))
    lens = case.cameras["cam"].intrinsics
    pose = realize(case, 0, 0).chaser_from_target
    steps = np.linspace(-1.2, 1.2, 601)
    sight = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    rays = np.column_stack([sight, np.ones(len(sight))])
    directions = pose.inv().rotation.apply(rays / np.linalg.norm(rays, axis=1, keepdims=True))
    hit = cast(Triangles.of(case.target), np.broadcast_to(pose.inv().translation, directions.shape), directions).valid
    pixels = lens.pixels_from_normalised(sight)
    inside = np.all((pixels > -0.5) & (pixels < [95.5, 63.5]), axis=1)
    assert photo.truth["visible_fraction"] == pytest.approx((hit & inside).sum() / hit.sum(), abs=0.01)
    assert 0.2 < photo.truth["visible_fraction"] < 0.9
