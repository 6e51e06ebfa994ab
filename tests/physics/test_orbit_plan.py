"""What a plan says of a tumble in orbit before anything is rendered."""

import pytest

from renderer.plan import plan
from scenes.errors import UsageError
from scenes.scenario import load_scenario


def test_a_plan_says_which_quaternions_are_normalised():
    """The paper's {P} to {B} has length 1.00055; what the file says stays in the resolved text."""
    case = load_scenario("song2017")
    warnings = plan(case, range(1)).warnings
    assert "target.reference_frame.quaternion_wxyz: the quaternion has length 1.00055, it is normalised" in warnings
    assert case.model_dump()["target"]["reference_frame"]["quaternion_wxyz"] == (0.76, 0.11, 0.55, -0.33)
    exact = load_scenario(
        "song2017",
        ["target.reference_frame.quaternion_wxyz=[1, 0, 0, 0]", "motion.inertial_from_body_wxyz=[0.5, 0.5, 0.5, 0.5]"],
    )
    assert not [text for text in plan(exact, range(1)).warnings if "quaternion" in text]


def test_a_roll_that_is_lost_between_the_frames_looked_at_is_refused_at_once():
    """The line of sight at 503 s as the reference: 64 looks at 1000 frames pass it by, the plan does not."""
    case = load_scenario("song2017")
    sight = case.trajectory.chaser_state(503.0, 0).inertial_from_chaser.as_matrix()[:, 2]
    bad = load_scenario("song2017", [f"motion.roll_reference={sight.tolist()}"])
    with pytest.raises(UsageError, match=r"motion\.roll_reference: at \d+ s the line of sight comes within .* name another"):
        plan(bad, range(bad.frame_count))
