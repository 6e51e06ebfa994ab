"""What is found out before hours are spent: lights inside the target, rigs that look past it, exposures that cannot work."""

from typing import Any

import numpy as np
import pytest
from oracles.studio import LAMBERT, box, camera, still

from renderer.plan import plan
from scenes.errors import UsageError
from scenes.inside import is_inside
from scenes.scenario import Scenario
from scenes.solids import solids
from scenes.target import Target

LAMP = {"type": "halogen", "position_m": (0.0, -1.0, 0.0), "power_w": 300.0}


def _case(exposure_s: float = 1e-2, toe_in_deg: float = 0.0, **changes: Any) -> Scenario:
    """A cube 10 m before a rig, under a lamp."""
    rig = {"type": "stereo", "baseline_m": 1.0, "toe_in_deg": toe_in_deg, "camera": camera(96, 64, 200.0, exposure_s) | _EIGHT_BITS}
    tree = {
        "frame_count": 5,
        "quality": "draft",
        "target": {"parts": [box((1.0, 1.0, 1.0))]},
        "rigs": {"eyes": rig},
        "lights": {"lamp": LAMP},
        "motion": still(10.0),
    }
    return Scenario.model_validate(tree | changes)


_EIGHT_BITS = {"detector": {"quantum_efficiency": 0.5, "full_well_e": 1e5, "gain_dn_per_e": 2.5e-3, "bits": 8}}


def test_a_plan_counts_pictures_and_grows_with_what_is_asked_for():
    small, large = plan(_case(), range(2)), plan(_case(quality="standard"), range(5))
    assert (small.frames, small.sensors, small.warnings) == (2, 2, ())
    assert large.cpu_s > 2 * small.cpu_s
    assert large.disk_bytes == pytest.approx(2.5 * small.disk_bytes, rel=0.05)
    assert "5 frames × 2 cameras" in large.sentence()


def test_a_lamp_inside_the_target_is_refused_by_name():
    with pytest.raises(UsageError, match=r"lights\.lamp: in frame 0 it stands inside the target's part 'box'"):
        plan(_case(lights={"lamp": LAMP | {"position_m": (0.2, 0.1, 10.3)}}), range(5))


def test_a_rig_that_looks_past_the_target_is_refused_by_name():
    with pytest.raises(UsageError, match=r"rigs\.eyes: in none of the 5 frames .* toe_in_deg \(40\)"):
        plan(_case(toe_in_deg=40.0), range(5))


def test_a_rig_whose_views_never_meet_is_refused_at_load():
    with pytest.raises(ValueError, match="their views do not overlap anywhere"):
        _case(toe_in_deg=-30.0)


@pytest.mark.parametrize(("exposure_s", "fault"), [(50.0, "saturates all that is lit"), (1e-7, "gives the target no light")])
def test_an_exposure_that_fails_in_every_frame_is_refused_by_name(exposure_s: float, fault: str):
    with pytest.raises(UsageError, match=rf"rigs\.eyes\.camera\.exposure: eyes-left {fault} .*in every frame tried \(0, 2, 4\)"):
        plan(_case(exposure_s), range(5))


def test_an_exposure_that_fails_in_some_frames_is_warned_about():
    away = {"type": "spin", "position_m": (0, 0, 10), "velocity_m_s": (0, 0, 25)}
    found = plan(_case(motion=away), range(5)).warnings
    assert any("gives the target no light that the camera could see in frame" in one for one in found)


def test_a_target_that_leaves_the_picture_is_warned_about():
    aside = {"type": "spin", "position_m": (0, 0, 10), "velocity_m_s": (0.5, 0, 0)}
    found = plan(_case(motion=aside), range(5)).warnings
    assert any(one.startswith("rigs.eyes: in ") and "does not hold the whole target" in one for one in found)


def test_inside_is_where_the_triangles_fill_the_whole_sphere():
    sphere = {"type": "sphere", "radius_m": 1.0, "subdivisions": 3}
    part = {"name": "ball", "shape": sphere, "material": LAMBERT, "centre_m": (1, 2, 3)}
    (ball,) = solids(Target.model_validate({"parts": [part]}))
    places = np.random.default_rng(0).uniform(-1.1, 1.1, (300, 3))
    radius = np.linalg.norm(places, axis=1)
    firm = np.abs(radius - 1) > 0.02  # the ball is made of triangles
    found = np.array([is_inside(ball, place + np.array([1, 2, 3])) for place in places])
    assert np.array_equal(found[firm], radius[firm] < 1)
    assert 50 < found.sum() < 250


def test_one_frame_alone_is_only_warned_about():
    """A shard of a data set has to render what the whole renders."""
    away = {"type": "spin", "position_m": (0, 0, 10), "velocity_m_s": (3.0, 0, 0)}
    assert plan(_case(motion=away), range(4, 5)).warnings
    dark = plan(_case(1e-7), range(1)).warnings
    assert any("gives the target no light" in one for one in dark)


def test_a_target_larger_than_the_pictures_is_seen():
    near = plan(_case(motion=still(2.0), target={"parts": [box((4.0, 4.0, 1.0))]}), range(5))
    assert any("does not hold the whole target" in one for one in near.warnings)


def test_noise_is_not_taken_for_light():
    noisy = {"detector": _EIGHT_BITS["detector"] | {"read_noise_e": 3000.0, "black_level_dn": 20}}
    rig = {"type": "stereo", "baseline_m": 1.0, "camera": camera(96, 64, 200.0, 1e-7) | noisy}
    with pytest.raises(UsageError, match="gives the target no light"):
        plan(_case(rigs={"eyes": rig}), range(5))


def test_a_spin_faster_than_the_blur_follows_is_refused_with_the_rigs_field():
    fast = still(10.0, omega_target_deg_s=(0.0, 90_000.0, 0.0))
    with pytest.raises(UsageError, match=r"rigs\.eyes\.camera\.exposure: the target turns"):
        plan(_case(motion=fast), range(5))


def test_a_lamp_that_stands_on_its_aim_is_a_sentence():
    with pytest.raises(UsageError, match=r"lights\.lamp\.position_m: in frame 0 the lamp stands where it is aimed at"):
        plan(_case(lights={"lamp": LAMP | {"position_m": (0.0, 0.0, 10.0)}}), range(5))
