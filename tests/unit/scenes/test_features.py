"""A rectangle that is none is refused where it is written, not where it is used."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pydantic import ValidationError

from scenes.features import RectangleFeature


def rectangle(**changes: object) -> RectangleFeature:
    return RectangleFeature.model_validate({"name": "wing", "centre_m": (0.1, 7.0, 0.0), "length_m": 10, "width_m": 3} | changes)


def test_corners_are_in_z_order_and_span_length_and_width():
    p1, p2, p3, p4 = rectangle().corners_target
    assert_allclose(p2 - p1, [0, 10, 0], atol=1e-15)
    assert_allclose(p3 - p1, [0, 0, 3], atol=1e-15)
    assert_allclose(p4, p2 + p3 - p1, atol=1e-15)
    assert_allclose((p1 + p4) / 2, [0.1, 7, 0], atol=1e-15)


def test_the_features_axes_are_normal_length_width():
    turned = rectangle(length_axis=(2, 0, 0), width_axis=(0, -1, 0))
    assert_allclose(turned.target_from_feature.apply(np.eye(3)), [[0, 0, -1], [1, 0, 0], [0, -1, 0]], atol=1e-15)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"length_axis": (0, 0, 0)}, "must not be zero"),
        ({"width_axis": (0, 0, 0)}, "must not be zero"),
        ({"width_axis": (0, 1, 1)}, "must be perpendicular, their cosine is 0.707"),
        ({"gap": (0.6, 0.4)}, "gap goes from 0.6 to 0.4"),
        ({"length_m": -1}, "greater than 0"),
    ],
)
def test_what_is_no_rectangle_is_refused(changes, says):
    with pytest.raises(ValidationError, match=says):
        rectangle(**changes)
