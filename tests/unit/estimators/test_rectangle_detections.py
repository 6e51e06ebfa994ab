"""The edges and corners that the rectangle methods name among their numbers lie on those of the picture."""

import numpy as np
import toy_renderer as toy
from toy_sweep import Answers

from estimators.mono_rectangle.paper import PaperRectangle
from estimators.mono_rectangle.quadrilateral import EDGE_NAMES
from estimators.mono_rectangle.tracked import TrackedRectangle


def _extras(estimator, sweep):
    """The true corners and the numbers of six frames from about the middle of the sweep, where no other edge is near."""
    few = type(sweep)(sweep.case, sweep.theta_deg[18:24], sweep.observations[18:24])
    answers = Answers.of(estimator, few, few.knowledge("span"))
    return [(toy.corners_px(few.truth(frame), "span"), one.extras) for frame, one in enumerate(answers.estimates) if one.extras]


def test_the_ends_of_each_edge_lie_on_the_true_edge(in_plane):
    found = _extras(TrackedRectangle(), in_plane)
    assert len(found) == 6
    for corners, extras in found:
        for name in EDGE_NAMES:
            first, last = (corners[int(name[place]) - 1] for place in (1, 3))
            ends = np.array([[extras[f"{name}_{axis}{end}_px"] for axis in "xy"] for end in (0, 1)])
            along = (last - first) / np.linalg.norm(last - first)
            across = (ends - first) @ np.array([-along[1], along[0]])
            assert np.abs(across).max() < 0.1
            assert np.linalg.norm(ends[1] - ends[0]) > 0.5 * np.linalg.norm(last - first)


def test_the_corners_are_where_the_paper_finds_them(in_plane):
    found = _extras(PaperRectangle(), in_plane)
    assert len(found) == 6
    for corners, extras in found:
        given = np.array([[extras[f"p{number}_{axis}_px"] for axis in "xy"] for number in (1, 2, 3, 4)])
        assert np.linalg.norm(given - corners, axis=1).max() < 4.0  # lines of 1 px and 1°
