"""From what a file says to one instant: streams, frames, lights, assembly."""

import numpy as np
import pytest
from pydantic import ValidationError

from scenes.scenario import Scenario, load_scenario, realize

RANDOM = {
    "motion": {
        "type": "random-views",
        "range_m": {"draw": "uniform", "low": 20.0, "high": 90.0},
        "right_deg": {"draw": "normal", "mean": 0.0, "sigma": 2.0},
    },
    "lights": {"sun": {"type": "sun", "direction": {"draw": "on-sphere"}}},
}


@pytest.fixture(scope="module")
def paper() -> Scenario:
    """Case 1."""
    return load_scenario("zhai2014-in-plane")


def _with(case: Scenario, **changes) -> Scenario:
    return Scenario.model_validate(case.model_dump() | changes)


def test_frames_follow_the_rate(paper: Scenario):
    doubled = _with(paper, rate_hz=2.0)
    assert realize(doubled, 0, 7).time_s == 3.5
    assert np.array_equal(
        realize(doubled, 0, 8).chaser_from_target.as_matrix(), realize(paper, 0, 4).chaser_from_target.as_matrix()
    )


def test_a_frame_is_the_same_alone_and_in_sequence(paper: Scenario):
    case = _with(paper, **RANDOM)
    in_sequence = [realize(case, 11, frame) for frame in range(6)]
    for frame in (5, 2, 0):
        alone, then = realize(case, 11, frame), in_sequence[frame]
        assert np.array_equal(alone.chaser_from_target.as_matrix(), then.chaser_from_target.as_matrix())
        assert np.array_equal(alone.lights[0].direction_chaser, then.lights[0].direction_chaser)
    poses = [scene.chaser_from_target.as_matrix() for scene in in_sequence]
    assert len(np.unique(np.round(poses, 9), axis=0)) == 6


def test_a_new_random_field_changes_no_other(paper: Scenario):
    case = _with(paper, **RANDOM)
    sun = RANDOM["lights"]["sun"]
    drifting = _with(case, lights={"sun": sun | {"distance_au": {"draw": "uniform", "low": 0.9, "high": 1.1}}})
    lower = _with(case, motion=RANDOM["motion"] | {"down_deg": {"draw": "uniform", "low": -3.0, "high": 3.0}})
    for frame in range(4):
        base, other_sun, other_view = (realize(one, 5, frame) for one in (case, drifting, lower))
        assert np.array_equal(base.chaser_from_target.as_matrix(), other_sun.chaser_from_target.as_matrix())
        assert np.array_equal(base.lights[0].direction_chaser, other_sun.lights[0].direction_chaser)
        assert base.lights[0].emitter.half_angle_rad != other_sun.lights[0].emitter.half_angle_rad
        assert np.array_equal(base.chaser_from_target.rotation.as_quat(), other_view.chaser_from_target.rotation.as_quat())
        assert np.array_equal(base.lights[0].direction_chaser, other_view.lights[0].direction_chaser)


def test_seeds_differ_and_zero_is_a_seed(paper: Scenario):
    case = _with(paper, **RANDOM)
    poses = [realize(case, seed, 3).chaser_from_target.as_matrix() for seed in (0, 0, 1)]
    assert np.array_equal(poses[0], poses[1])
    assert not np.allclose(poses[0], poses[2])


def test_the_motion_goes_on_around_the_frame(paper: Scenario):
    scene = realize(paper, 0, 100)
    assert np.array_equal(scene.pose_at(scene.time_s).as_matrix(), scene.chaser_from_target.as_matrix())
    later = (scene.chaser_from_target.rotation.inv() * scene.pose_at(scene.time_s + 0.5).rotation).as_rotvec()
    assert later == pytest.approx(0.5 * np.array(scene.omega_target_rad_s), abs=1e-12)


@pytest.mark.parametrize(
    ("name", "frames", "middle", "glint_deg"),
    [("zhai2014-in-plane", 839, 419.31, 20.0), ("zhai2014-out-of-plane", 721, 360.0, -15.0)],
)
def test_the_papers_sweeps_are_symmetric_and_the_glint_hits_the_camera(name: str, frames: int, middle: float, glint_deg: float):
    case, glint = load_scenario(name), load_scenario(f"{name}-glint")
    assert case.frame_count == glint.frame_count == frames
    assert case.motion.angle_rad(middle) == pytest.approx(0.0, abs=1e-12)
    assert case.motion == glint.motion
    time_s = (glint_deg - case.motion.start_deg) / case.motion.rate_deg_s
    pose = glint.motion.chaser_from_target(time_s, 0, 0)
    normal = pose.rotation.apply([1.0, 0.0, 0.0])
    sun = np.array(glint.lights["sun"].direction)
    to_camera = np.array([0.0, 0.0, -1.0])
    assert 2 * (normal @ to_camera) * normal - to_camera == pytest.approx(sun, abs=1e-9)


def test_numbers_out_of_bounds_are_refused(paper: Scenario):
    tree = paper.model_dump()
    for changes in ({"seed": -1}, {"frame_count": 0}, {"rate_hz": 0.0}, {"quality": "best"}, {"cameras": {}}, {"lights": {}}):
        with pytest.raises(ValidationError):
            Scenario.model_validate(tree | changes)
    with pytest.raises(ValidationError, match="pattern"):
        Scenario.model_validate(tree | {"cameras": {"../up": tree["cameras"]["nav"]}})


def test_a_scenario_survives_its_own_json(paper: Scenario):
    case = _with(paper, **RANDOM)
    assert Scenario.model_validate_json(case.model_dump_json()) == case
    assert [part.name for part in case.target.parts] == ["body", "wing+y", "yoke+y", "wing-y", "yoke-y"]
