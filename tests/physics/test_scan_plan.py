"""What is found out before a LIDAR's hours are spent: that it never meets the target, that scans stay empty; and what it costs."""

from typing import Any

import pytest
from oracles.soundings import lidar, scenario
from oracles.studio import LAMBERT, box, camera, still

from renderer.plan import plan
from scenes.errors import UsageError
from scenes.scenario import Scenario

ALL = range(8)


def _case(motion: dict[str, Any] | None = None, ranging: dict[str, Any] | None = None, **changes: Any) -> Scenario:
    """A cube at 20 m before a flash of 1 deg."""
    more = {name: changes.pop(name) for name in ("cameras", "lights") if name in changes}
    return scenario([box((1.0, 1.0, 1.0), LAMBERT)], lidar(ranging, **changes), motion or still(20.0), **more)


def test_a_plan_counts_scans():
    one = plan(_case(), ALL)
    assert (one.frames, one.sensors, one.scans, one.warnings) == (8, 0, (256,), ())
    assert one.sentence().startswith("8 frames × 1 LIDAR (256 points), about")
    assert one.cpu_s > 0
    assert 8 * 200 < one.disk_bytes < 8 * 20_000


def test_cameras_and_lidars_stand_side_by_side_in_a_plan():
    both = _case(cameras={"cam": camera()}, lights={"sun": {"type": "sun", "direction": (0.0, 0.0, -1.0)}})
    assert "8 frames × 1 camera and 1 LIDAR (256 points)" in plan(both, ALL).sentence()


@pytest.mark.parametrize(
    ("changes", "motion"),
    [
        ({"mount": {"rotation_vector_deg": (0.0, 90.0, 0.0)}}, still(20.0)),
        ({}, still(20.0) | {"position_m": (5.0, 0.0, 20.0)}),
        ({}, still(-20.0)),
    ],
)
def test_a_lidar_that_never_meets_the_target_is_refused_by_name(changes: dict[str, Any], motion: dict[str, Any]):
    fault = r"lidars\.lidar: in none of the 8 frames looked at does a beam meet the target.* look at pattern, mount and the"
    with pytest.raises(UsageError, match=fault):
        plan(_case(motion, **changes), ALL)


def test_a_gate_that_leaves_everything_out_is_refused_by_name():
    with pytest.raises(UsageError, match=r"lidars\.lidar\.gate_m: .* 1 to 10 m; the nearest of it is 19\.5 m away"):
        plan(_case(gate_m=(1.0, 10.0)), ALL)


def test_a_gate_that_leaves_out_what_only_some_scans_meet_is_refused_too():
    passing = still(20.0) | {"position_m": (-1.5, 0.0, 20.0), "velocity_m_s": (0.4, 0.0, 0.0)}  # in the field from 2.1 to 5.4 s
    assert "a scan has no return in 5 of 8 frames" in plan(_case(passing), ALL).warnings[0]
    with pytest.raises(UsageError, match=r"lidars\.lidar\.gate_m: .* 1 to 10 m; the nearest of it is 19\.5 m away"):
        plan(_case(passing, gate_m=(1.0, 10.0)), ALL)


def test_one_frame_that_misses_may_be_meant_and_is_said():
    missed = plan(_case(still(-20.0)), range(1))
    assert missed.warnings == ("lidars.lidar: a scan has no return in 1 of 1 frames looked at (0); no beam meets the target",)


def test_scans_that_stay_empty_are_said_with_the_reason():
    dark = plan(_case(ranging={"threshold_e": 1e12}), ALL)
    assert "no return in 8 of 8 frames" in dark.warnings[0]
    assert "beams that meet it: 2048 dark" in dark.warnings[0]
    leaving = still(20.0) | {"velocity_m_s": (0.2, 0.0, 0.0)}
    some = plan(_case(leaving), ALL)  # its left side leaves the field of ±0.17 m after 3.4 s
    assert "no return in 4 of 8 frames looked at (4, 5, 6, 7); no beam meets the target" in some.warnings[0]
