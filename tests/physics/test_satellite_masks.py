"""The small satellite in a rig's pictures: light masks and what the other camera sees, against rays traced by Open3D."""

from dataclasses import dataclass

import numpy as np
import pytest
from oracles.open3d_rays import Open3dScene, Seen
from oracles.studio import inside

from renderer.masks import Light
from renderer.photograph import Photograph, Photographer
from scenes.arrays import Bools, Floats
from scenes.scenario import Scenario, Scene, load_scenario, realize

STATES = (Light.LIT, Light.ATTACHED_SHADOW, Light.CAST_SHADOW)
CASES = [("shu2020-exp3", 0), ("ring-terminator", 20), ("ring-sun-glint", 5)]
SMALLER = "rigs.stereo.camera={ base = 'lab-4mp', width_px = 1024, height_px = 1024, pixel_pitch_m = 11e-6 }"


@dataclass(frozen=True)
class Shot:
    """One picture of a rig's left camera and the same pixels seen by Open3D."""

    case: Scenario
    scene: Scene
    photo: Photograph
    rays: Open3dScene
    seen: Seen

    def bits(self, state: Light) -> Bools:
        """Pixels in one state."""
        return np.asarray((self.photo.layers["mask"] & np.uint32(state)) > 0)


@pytest.fixture(scope="module", params=CASES, ids=[name for name, _ in CASES])
def shot(request: pytest.FixtureRequest) -> Shot:
    """At half the resolution, many light samples and no indirect light, which the masks do not need."""
    from renderer.quality import Preset

    name, frame = request.param
    case = load_scenario(name, [SMALLER])
    scene = realize(case, case.seed, frame)
    photo = Photographer(case, "stereo-left", Preset(64, 0, denoise_indirect=False)).take(scene)
    camera, rays = case.sensors["stereo-left"], Open3dScene(case.target)
    cam_from_target = camera.mount.chaser_from_cam.inv() * scene.chaser_from_target
    return Shot(case, scene, photo, rays, rays.seen(camera.intrinsics, cam_from_target, photo.window))


def _light_place(scene: Scene) -> Floats:
    """The middle of the key light, or a place far out in its direction."""
    emitter = scene.lights[0].emitter
    return np.asarray(getattr(emitter, "centre_target", 1e5 * scene.lights[0].direction_target))


def test_light_masks_are_disjoint_and_complete_on_the_target(shot: Shot):
    states = np.sum([shot.bits(state) for state in STATES], axis=0)
    on_target = shot.photo.layers["part_id"] > 0
    assert np.array_equal(states, on_target)
    assert (shot.photo.layers["mask"][~on_target] == 0).all()
    assert shot.photo.truth["lit_fraction"] + shot.photo.truth["shadow_fraction"] == pytest.approx(1.0, abs=1e-12)


def test_parts_and_depths_are_those_of_another_ray_tracer(shot: Shot):
    part_id = shot.photo.layers["part_id"]
    assert np.mean(part_id == shot.seen.part_id) > 0.9998  # pixel centres that graze an edge
    same = (part_id == shot.seen.part_id) & (part_id > 0)
    depth = np.where(same, shot.photo.layers["z_m"], 0)
    axis = shot.case.sensors["stereo-left"].intrinsics
    rows, columns = np.nonzero(same)
    rays = axis.rays(np.column_stack([columns + shot.photo.window.x_px, rows + shot.photo.window.y_px]).astype(float))
    error = np.abs(depth[rows, columns] - shot.seen.range_m[rows, columns] * rays[:, 2])
    assert np.percentile(error, 99.5) < 2e-5


def test_shadows_agree_with_independent_rays_away_from_penumbrae(shot: Shot):
    place = _light_place(shot.scene)
    facing = shot.seen.hit & shot.rays.facing(shot.seen, place)
    open_ = facing & shot.rays.reaches(shot.seen, place)
    expected = [open_, shot.seen.hit & ~facing, facing & ~open_]
    firm = _firm(shot, expected)
    assert firm.sum() > 10_000
    agreement = np.mean([shot.bits(state)[firm] == own[firm] for state, own in zip(STATES, expected)])
    print(f"shadow masks: {100 * agreement:.3f} % of {firm.sum()} pixels")
    assert agreement >= 0.999
    assert min((firm & one).sum() for one in expected[1:]) > 50


def _firm(shot: Shot, expected: list[Bools]) -> Bools:
    """Pixels of one state that see one side of a facet, away from where the light's disk is cut."""
    share = shot.photo.layers["unshadowed"] / np.maximum(shot.photo.layers["coverage"], 1e-6)
    whole = (share < 0.02) | (share > 0.98)
    return np.logical_or.reduce([inside(one, 1) for one in expected]) & whole


def test_what_the_other_camera_cannot_see_agrees_with_independent_rays(shot: Shot):
    left, right = (shot.case.sensors[name] for name in ("stereo-left", "stereo-right"))
    place = shot.scene.chaser_from_target.inv().apply(right.mount.chaser_from_cam.translation)
    visible = shot.seen.hit & shot.rays.facing(shot.seen, place) & shot.rays.reaches(shot.seen, place)
    right_from_target = right.mount.chaser_from_cam.inv() * shot.scene.chaser_from_target
    points_right = right_from_target.apply(shot.seen.points_target.reshape(-1, 3))
    pixels = right.intrinsics.project(points_right).reshape(*visible.shape, 2)
    inside_picture = np.all((pixels >= -0.5) & (pixels < left.intrinsics.width_px - 0.5), axis=-1)
    hidden = shot.seen.hit & ~(visible & inside_picture)
    firm = shot.seen.hit & (inside(hidden, 1) | inside(~hidden, 1))
    rendered = shot.photo.layers["hidden_from_partner"] > 0
    agreement = np.mean(rendered[firm] == hidden[firm])
    print(f"hidden from the other camera: {100 * agreement:.3f} % of {firm.sum()} pixels, {100 * hidden[firm].mean():.1f} % hidden")
    assert agreement >= 0.999
    assert (firm & hidden).sum() > 300
