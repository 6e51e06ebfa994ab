"""Quaternions in files: kept as written, normalised in use, refused where they are not nearly of length one."""

import numpy as np
import pytest
from pydantic import Field, ValidationError

from scenes.quaternion import Quaternion, quaternion_notes, rotation
from scenes.spec import Spec

PAPER_WXYZ = (0.76, 0.11, 0.55, -0.33)  # Song et al. 2017, section 5.1: its length is 1.00055


class _Turn(Spec):
    quaternion_wxyz: Quaternion


class _Holder(Spec):
    one: _Turn
    more: dict[str, _Turn] = Field(default_factory=dict)
    listed: tuple[_Turn, ...] = ()
    frame_from_body_wxyz: Quaternion | None = None


def test_three_digits_are_enough_and_stay_as_they_were_written():
    turn = _Turn(quaternion_wxyz=PAPER_WXYZ)
    assert turn.model_dump() == {"quaternion_wxyz": PAPER_WXYZ}
    w, x, y, z = np.array(PAPER_WXYZ) / np.linalg.norm(PAPER_WXYZ)
    assert rotation(turn.quaternion_wxyz).as_quat() == pytest.approx([x, y, z, w], abs=1e-15)


@pytest.mark.parametrize("factor", [1.0011, 0.9989, 2.0, 0.0])
def test_another_length_is_refused_with_both_values(factor: float):
    with pytest.raises(ValidationError, match=rf"has length {factor:.6g}, must be 1 within 0.001"):
        _Turn(quaternion_wxyz=(factor, 0.0, 0.0, 0.0))
    assert _Turn(quaternion_wxyz=(1.0009, 0.0, 0.0, 0.0))


def test_notes_name_every_quaternion_that_was_normalised():
    off, exact = _Turn(quaternion_wxyz=PAPER_WXYZ), _Turn(quaternion_wxyz=(0.6, 0.0, 0.8, 0.0))
    holder = _Holder(one=off, more={"a": exact, "b": off}, listed=(exact, off), frame_from_body_wxyz=(1.0002, 0, 0, 0))
    assert quaternion_notes(holder) == [
        "one.quaternion_wxyz: the quaternion has length 1.00055, it is normalised",
        "more.b.quaternion_wxyz: the quaternion has length 1.00055, it is normalised",
        "listed.1.quaternion_wxyz: the quaternion has length 1.00055, it is normalised",
        "frame_from_body_wxyz: the quaternion has length 1.0002, it is normalised",
    ]
    assert quaternion_notes(_Holder(one=exact)) == []
