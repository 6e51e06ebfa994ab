"""Which frames a text selects."""

import pytest

from scenes.dataset_range import parse_frames
from scenes.errors import UsageError


@pytest.mark.parametrize(
    ("text", "frames"),
    [
        ("0:40", range(40)),
        ("7", range(7, 8)),
        (" 3 : 9 : 2 ", range(3, 9, 2)),
        (":", range(839)),
        ("::20", range(0, 839, 20)),
        ("830:", range(830, 839)),
        (":5", range(5)),
        ("838", range(838, 839)),
        ("19:820:20", range(19, 820, 20)),
    ],
)
def test_as_a_slice(text, frames):
    assert parse_frames(text, 839) == frames
    assert list(frames) == list(range(839))[frames.start : frames.stop : frames.step]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("0:840", r"'0:840' lies outside the scenario, which has frames 0 to 838 \(0:839\)"),
        ("839", "lies outside"),
        ("-1", "lies outside"),
        ("-5:9", "lies outside"),
        ("839:", "lies outside"),
        ("5:5", "selects no frame: the start 5 is not below the stop 5"),
        ("9:5", "selects no frame"),
        ("0:9:0", "has step 0; a step is at least 1"),
        ("9:0:-1", "has step -1"),
        ("a:b", "'a' is not a whole number"),
        ("1.5", "'1.5' is not a whole number"),
        ("1:2:3:4", "has 4 parts"),
        ("", "is empty"),
        ("  ", "is empty"),
    ],
)
def test_what_is_no_range_is_one_sentence(text, says):
    with pytest.raises(UsageError, match=says) as caught:
        parse_frames(text, 839)
    assert str(caught.value).startswith("--frames")
    assert caught.value.exit_status == 2
