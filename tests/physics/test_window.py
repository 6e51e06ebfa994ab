"""The window that follows the target changes what a picture costs, not what it shows."""

from dataclasses import replace

import numpy as np
from oracles.studio import Studio, box, camera, direct, scenario, still

from renderer.photograph import Photographer
from renderer.quality import Preset
from scenes.exr import Window
from scenes.scenario import Scenario, realize

SAMPLES = Preset(64, 16, denoise_indirect=False)
GEOMETRY = ("part_id", "z_m", "normal.x", "normal.y", "normal.z")


def _case(**changes) -> Scenario:
    drift = still(20.0, (30.0, 40.0, 10.0), velocity_m_s=(3.0, -1.5, 0.0))
    parts = [box((2.0, 1.0, 0.5)), box((0.2, 3.0, 0.8), name="fin", centre_m=(0.8, 0.5, 0.3))]
    cam = camera(320, 240, 400.0, 1e-4, principal_point_px=(150.3, 127.9))
    return scenario(parts, cam, drift, frame_count=3, sun={"direction": (0.4, -0.3, -1.0)}, **changes)


def test_a_moving_window_shows_what_the_whole_picture_shows():
    case = _case()
    whole, small = Studio(case, SAMPLES), Studio(case, SAMPLES, size=(112, 96))
    for frame in range(3):
        everything, part = whole.view(frame), small.view(frame)
        rows, columns = part.window.slices
        truth, cut = whole.session.geometry(everything), small.session.geometry(part)
        for name in GEOMETRY:
            outside = truth[name].copy()
            assert np.array_equal(outside[rows, columns], cut[name])  # bit by bit
            outside[rows, columns] = 0
            assert not outside.any()
        pictures = [
            np.array([direct(one) + one["indirect_raw"] for one in studio.repeats(replace(view, frame=frame), range(12))])
            for studio, view in ((whole, everything), (small, part))
        ]
        first, second = pictures[0][:, rows, columns], pictures[1]
        sigma = np.sqrt((first.var(axis=0, ddof=1) + second.var(axis=0, ddof=1)) / 12)
        gap = first.mean(axis=0) - second.mean(axis=0)
        lit = sigma > 1e-3 * first.max()
        assert np.sqrt(np.mean((gap[lit] / sigma[lit]) ** 2)) < 1.25  # 1.0 within Student's tails
        assert abs(gap.sum()) < 5 * np.sqrt(np.sum(sigma**2))


def test_a_frame_alone_equals_the_frame_in_sequence():
    case = _case(quality="fast")
    in_sequence, alone = Photographer(case, "cam"), Photographer(case, "cam")
    taken = [in_sequence.take(realize(case, 0, frame)) for frame in range(3)]
    for frame in (2, 0):
        again = alone.take(realize(case, 0, frame))
        assert np.array_equal(again.pixels, taken[frame].pixels)
        assert again.truth == taken[frame].truth
        assert again.window == taken[frame].window
        for name, layer in taken[frame].layers.items():
            assert np.array_equal(again.layers[name], layer), name


def test_frames_and_seeds_differ_in_noise_only():
    case = _case(quality="fast")
    studio = Studio.following(case)
    window = Window(100, 80, 112, 96)
    same = [studio.session.radiance(replace(studio.view(0, window=window), frame=frame)) for frame in (0, 1)]
    other_seed = studio.session.radiance(studio.view(0, seed=1, window=window))
    for layers in (same[1], other_seed):
        assert not np.array_equal(direct(layers), direct(same[0]))
        assert abs(direct(layers).sum() / direct(same[0]).sum() - 1) < 0.01


def test_two_cameras_at_one_place_have_independent_noise():
    case = _case(quality="fast")
    twins = Scenario.model_validate(case.model_dump() | {"cameras": {"left": case.cameras["cam"], "right": case.cameras["cam"]}})
    left, right = (Photographer(twins, name).take(realize(twins, 0, 0)) for name in ("left", "right"))
    assert np.array_equal(left.layers["part_id"], right.layers["part_id"])
    assert not np.array_equal(left.layers["direct_diffuse"], right.layers["direct_diffuse"])
    assert not np.array_equal(left.layers["indirect_raw"], right.layers["indirect_raw"])
    # Quiet parts are alike: it is the same scene.
    assert np.corrcoef(left.layers["direct_diffuse"].ravel(), right.layers["direct_diffuse"].ravel())[0, 1] > 0.99
