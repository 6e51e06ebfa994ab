"""``mono-rectangle-paper``: the method as printed, with the property that it answers 0 on the face."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation
from toy_sweep import INTRINSICS, Answers, observation

from estimators.api import Estimator, Outcome
from estimators.mono_rectangle.paper import PaperRectangle
from scenes.recording import Rectangle


def test_the_face_is_said_to_be_fronto_parallel_in_most_frames(in_plane, out_of_plane):
    """One degree of the Hough transform is more than the face's whole perspective: the error is minus the angle."""
    for sweep in (in_plane, out_of_plane):
        answers = sweep.run(PaperRectangle(), "face")
        assert answers.ok.sum() >= 30
        said = (answers.error_deg + answers.theta_deg)[answers.ok]
        assert np.mean(np.abs(said) < 1.0) > 0.8
        assert answers.sigma_deg > 15


def test_the_longer_the_rectangle_the_better(in_plane):
    """Case 1: span 3°, wing 7-8°, face 25°."""
    span, wing, face = (in_plane.run(PaperRectangle(), region).sigma_deg for region in ("span", "wing", "face"))
    assert 2 < span < 4.5 < wing < 12 < face
    assert in_plane.run(PaperRectangle(), "span").ok.all()


def test_equal_brightness_leaves_no_line(in_plane):
    assert in_plane.run(PaperRectangle(), "face").failed_between(-13.5, -11.9)


def test_contract(in_plane):
    assert isinstance(PaperRectangle(), Estimator)
    few = type(in_plane)(1, in_plane.theta_deg[:5], in_plane.observations[:5])
    turned_by = Rotation.from_euler("xyz", [20, -35, 50], degrees=True)
    one, again = (Answers.of(PaperRectangle(), few, in_plane.knowledge("span")) for _ in range(2))
    turned = Answers.of(PaperRectangle(), few, in_plane.knowledge("span", rectangle=Rectangle("span", turned_by)))
    for a, b, c in zip(one.estimates, again.estimates, turned.estimates, strict=True):
        assert np.array_equal(a.sensor_from_target.as_quat(), b.sensor_from_target.as_quat())
        assert (a.sensor_from_target.inv() * c.sensor_from_target * turned_by).magnitude() < 1e-12


@pytest.mark.parametrize("value", [0, 255])
def test_nothing_to_see_is_a_failure(in_plane, value):
    method = PaperRectangle()
    method.start(in_plane.knowledge("face"))
    shape = (INTRINSICS.height_px, INTRINSICS.width_px)
    for dtype in (np.uint8, np.uint16):
        estimate = method.step(observation(0, 0.0, np.full(shape, value, dtype)))
        assert estimate.outcome is Outcome.NO_FEATURES
        assert estimate.reason == "no Hough line in the band about p1p2, p3p4, p1p3, p2p4"


def test_a_quadrilateral_outside_the_picture_is_a_failure(in_plane):
    method, told = PaperRectangle(), in_plane.knowledge("face")
    for shift in (-2000.0, 2000.0):
        prior = type(told.corner_prior)("cam", told.corner_prior.corners_px + shift, 3.0)
        method.start(in_plane.knowledge("face", corner_prior=prior))
        assert method.step(in_plane.observations[0]).outcome is Outcome.NO_FEATURES


def test_parameters():
    assert PaperRectangle(theta_deg=0.1).parameters.theta_deg == 0.1
    with pytest.raises(ValidationError, match="canny"):
        PaperRectangle(canny=3)
