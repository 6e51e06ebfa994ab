"""A moving target: the blurred picture is the mean of sharp ones, and truth is that of the middle of the exposure."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.studio import Studio, box, camera, direct, scenario, still

from renderer.photograph import Photographer
from renderer.quality import Preset
from renderer.sensor import Shutter
from scenes.arrays import Floats
from scenes.scenario import realize

EXPOSURE_S = 0.05
# 4.5 px of drift and 3° of turn at 10 m: the camera moves on an arc of half a metre about the target.
MOTION = still(10.0, (10.0, 20.0, 30.0), velocity_m_s=(3.0, 1.0, 0.0), omega_target_deg_s=(0.0, 0.0, 60.0))
SAMPLES = Preset(64, 0, denoise_indirect=False)
SUB_FRAMES, SEEDS = 64, 64


@pytest.fixture(scope="module")
def blurred_and_mean() -> tuple[Floats, Floats, Floats]:
    """Pictures of 64 seeds with blur (n, h, w), and the mean of 64 sharp ones, each with its own seed, twice."""
    case = scenario([box((2.0, 1.2, 0.3))], camera(96, 64, 300.0, EXPOSURE_S), MOTION)
    moving, sharp = Studio(case, SAMPLES, moving=True), Studio(case, SAMPLES)
    view = moving.view(exposure_s=EXPOSURE_S)
    stack = np.array([direct(layers) for layers in moving.repeats(view, range(SEEDS))])
    means = []
    for series in range(2):
        pictures = []
        for step in range(SUB_FRAMES):
            instant_s = ((step + 0.5) / SUB_FRAMES - 0.5) * EXPOSURE_S
            pose = sharp.scene().pose_at(instant_s).inv()  # this camera's axes are the chaser's
            # The sun stands still before the chaser, so it turns in the target's frame.
            sun = view.lights[0]
            towards = pose.rotation.apply(np.array(sun.direction_chaser))
            light = replace(sun, direction_target=towards, emitter=replace(sun.emitter, direction_target=towards))
            still_view = replace(view, lights=(light,), shutter=Shutter.between(pose, pose, pose), seed=1000 * series + step)
            pictures.append(direct(sharp.session.radiance(still_view)))
        means.append(np.mean(pictures, axis=0))
    return stack, means[0], means[1]


def test_blur_is_the_mean_of_sub_frames(blurred_and_mean: tuple[Floats, Floats, Floats]):
    stack, first, second = blurred_and_mean
    reference = (first + second) / 2
    scale = reference.max()
    error = stack.mean(axis=0) - reference
    noise = np.hypot(stack.std(axis=0, ddof=1) / np.sqrt(len(stack)), np.abs(first - second) / 2)
    assert np.sqrt(np.mean(error[reference > 0] ** 2)) < 0.0015 * scale  # measured 0.0009, of which 0.0008 are noise
    assert np.percentile(np.abs(error)[reference > 0] / np.maximum(noise, 1e-3 * scale)[reference > 0], 99) < 4
    assert stack.mean(axis=0).sum() == pytest.approx(reference.sum(), rel=2e-4)


def test_blur_reaches_as_far_as_the_target_moves(blurred_and_mean: tuple[Floats, Floats, Floats]):
    stack, _, _ = blurred_and_mean
    case = scenario([box((2.0, 1.2, 0.3))], camera(96, 64, 300.0, EXPOSURE_S), MOTION)
    sharp = direct(Studio(case, SAMPLES).session.radiance(Studio(case, SAMPLES).view()))
    softened = stack.mean(axis=0)
    assert ((softened > 0) & (sharp == 0)).sum() > 150  # the outline grows by what moves into the picture's dark
    assert softened.sum() == pytest.approx(sharp.sum(), rel=0.02)


def test_truth_is_that_of_mid_exposure_and_the_window_holds_the_whole_motion():
    # 13 px within the exposure: more than the window's margin.
    motion = still(10.0, (10.0, 20.0, 30.0), velocity_m_s=(10.0, 0.0, 0.0))
    case = scenario([box((2.0, 1.2, 0.3))], camera(192, 128, 300.0, EXPOSURE_S), motion, quality="draft")
    photo = Photographer(case, "cam").take(realize(case, 0, 0))
    row = photo.truth
    assert (row["tx_m"], row["ty_m"], row["tz_m"]) == pytest.approx((0.0, 0.0, 10.0), abs=1e-12)
    still_case = scenario(
        [box((2.0, 1.2, 0.3))], camera(192, 128, 300.0, EXPOSURE_S), still(10.0, (10.0, 20.0, 30.0)), quality="draft"
    )
    sharp = Photographer(still_case, "cam").take(realize(still_case, 0, 0))
    full = [np.zeros((128, 192), np.uint32) for _ in range(2)]
    for canvas, one in zip(full, (photo, sharp)):
        canvas[one.window.slices] = one.layers["part_id"]
    assert np.array_equal(*full)
    light = [one.layers["direct_diffuse"].sum() for one in (photo, sharp)]
    assert light[0] == pytest.approx(light[1], rel=0.003)  # nothing of the smeared target is cut off
    assert photo.layers["coverage"][:, [0, -1]].max() == photo.layers["coverage"][[0, -1], :].max() == 0.0
