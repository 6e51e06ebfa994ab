"""Shadows: the penumbra of a disk, and the masks against a ray caster of our own."""

import numpy as np
import pytest
from oracles.raycaster import Triangles, cast, pixel_rays
from oracles.studio import Studio, box, camera, direct, inside, scenario, still

from renderer.masks import Light
from renderer.photograph import Photographer
from renderer.quality import Preset
from scenes.arrays import Bools, Floats
from scenes.scenario import realize

STATES = (Light.LIT, Light.ATTACHED_SHADOW, Light.CAST_SHADOW)


def test_the_penumbra_is_as_wide_as_the_sun_and_shaped_like_its_disk():
    # A straight edge 5 m over the ground, the sun at 45°: 7.07 m along the ray. The ground is seen at 2 mm a pixel.
    ground = box((20.0, 20.0, 0.1), centre_m=(0.0, 0.0, 0.05))
    roof = box((10.0, 20.0, 1e-4), name="roof", centre_m=(10.0, 0.0, -5.0))
    case = scenario([ground, roof], camera(96, 16, 5000.0), still(10.0), sun={"direction": (1.0, 0.0, -1.0)})
    studio = Studio(case, Preset(256, 0, denoise_indirect=False))
    light = direct(studio.session.radiance(studio.view())).mean(axis=0)
    x_m = (np.arange(96) - 47.5) * 0.002
    half_width_m = 5 * np.sqrt(2) * np.radians(0.5332 / 2) * np.sqrt(2)
    assert 4 * half_width_m == pytest.approx(0.186, rel=0.01)  # twice 7.07 m × 0.533° over cos 45°
    u = np.clip(-x_m / half_width_m, -1, 1)
    seen = 0.5 + (u * np.sqrt(1 - u**2) + np.arcsin(u)) / np.pi
    assert np.abs(light / light.max() - seen).max() < 0.02
    assert np.sqrt(np.mean((light / light.max() - seen) ** 2)) < 0.005


@pytest.mark.parametrize(("case", "frame"), [("in_plane", 0), ("in_plane", 150), ("out_of_plane", 200), ("out_of_plane", 650)])
def test_masks_agree_with_a_ray_caster_of_our_own(case: str, frame: int, request: pytest.FixtureRequest):
    scenario_ = request.getfixturevalue(case)
    photo = Photographer(scenario_.model_copy(update={"quality": "fast"}), "nav").take(realize(scenario_, 0, frame))
    mask, part_id = photo.layers["mask"], photo.layers["part_id"]
    states = [(mask & np.uint32(state)) > 0 for state in STATES]
    assert np.array_equal(np.sum(states, axis=0), part_id > 0)  # exactly one on the target, none beside it
    studio: Studio = request.getfixturevalue(f"{case}_studio")
    expected = _states(studio, frame, photo.window)
    firm = np.logical_or.reduce([inside(one, 2) for one in expected])  # penumbrae are up to 2.4 px wide
    assert firm.sum() > 15000
    assert (firm & (expected[1] | expected[2])).sum() > 50
    for rendered, own in zip(states, expected):
        assert np.mean(rendered[firm] == own[firm]) > 0.9995  # measured: every one; the promise is 0.999
    fractions = photo.truth["lit_fraction"] + photo.truth["shadow_fraction"]
    assert fractions == pytest.approx(1.0, abs=1e-12)
    assert photo.truth["lit_fraction"] == pytest.approx(states[0].sum() / (part_id > 0).sum(), abs=1e-12)


def _states(studio: Studio, frame: int, window) -> list[Bools]:
    """Lit, attached shadow, cast shadow (h, w) at pixel centres, for the centre of the sun."""
    triangles = Triangles.of(studio.scenario.target)
    to_sun = studio.scene(frame).lights[0].direction_target
    origins, directions = pixel_rays(studio.camera.intrinsics, studio.cam_from_target(frame), window)
    hits = cast(triangles, origins, directions)
    normal = triangles.normals[hits.triangle]
    points: Floats = origins + np.where(hits.valid, hits.distance, 0.0)[:, None] * directions + 1e-4 * normal
    facing = normal @ to_sun > 0
    blocked = cast(triangles, points, np.broadcast_to(to_sun, points.shape)).valid
    states = [hits.valid & facing & ~blocked, hits.valid & ~facing, hits.valid & facing & blocked]
    return [state.reshape(window.height_px, window.width_px) for state in states]


def test_a_glint_is_marked_specular_and_saturated():
    # The wing mirrors the sun into the camera at θ = 20°, frame 619.
    from scenes.scenario import load_scenario

    glint = load_scenario("zhai2014-in-plane-glint", ["quality=fast"])
    photographer = Photographer(glint, "nav")
    at_mirror, before = (photographer.take(realize(glint, 0, frame)) for frame in (619, 319))
    on_wings = np.isin(at_mirror.layers["part_id"], (2, 4))
    assert (at_mirror.layers["mask"][on_wings] & Light.SPECULAR > 0).mean() > 0.95
    assert (at_mirror.layers["mask"][on_wings] & Light.SATURATED > 0).mean() > 0.7  # the tips see it 7° aside
    assert at_mirror.truth["saturated_fraction"] > 0.6
    assert before.truth["specular_fraction"] < 0.01
    assert before.truth["saturated_fraction"] == 0.0
