"""A feature that is none is refused where it is written, not where it is used."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pydantic import TypeAdapter, ValidationError

from scenes.features import CircleFeature, Feature, MarkerFeature, RectangleFeature


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


def circle(**changes: object) -> CircleFeature:
    return CircleFeature.model_validate({"type": "circle", "name": "ring", "radius_m": 0.6} | changes)


def test_a_circle_lies_in_its_plane_and_starts_on_its_x_axis():
    tilted = circle(centre_m=(1, 2, 3), normal=(0, 3, 4), x_axis=(2, 0, 0))
    points = tilted.points_target(8)
    assert_allclose(points[0], [1.6, 2, 3], atol=1e-15)
    assert_allclose(np.linalg.norm(points - [1, 2, 3], axis=1), 0.6)
    assert_allclose((points - [1, 2, 3]) @ [0, 0.6, 0.8], 0, atol=1e-15)
    assert np.cross(points[0] - [1, 2, 3], points[1] - [1, 2, 3]) @ [0, 0.6, 0.8] > 0  # counter-clockwise seen from outside
    assert_allclose(points.mean(axis=0), [1, 2, 3], atol=1e-15)


def test_what_lies_on_a_surface_has_z_outwards_and_x_where_it_says():
    marker = MarkerFeature.model_validate(
        {
            "type": "marker",
            "name": "m",
            "centre_m": (0, 0, 2),
            "normal": (0, -5, 0),
            "x_axis": (0, 0, 2),
            "shape": "disc",
            "size_m": 0.1,
        }
    )
    assert_allclose(marker.target_from_feature.apply(np.eye(3)), [[0, 0, 3], [-1, 0, 2], [0, -1, 2]], atol=1e-15)
    assert marker.bright is False


def test_a_feature_is_told_by_its_type_and_a_rectangle_needs_none():
    read = TypeAdapter(Feature).validate_python
    assert isinstance(read({"name": "r", "centre_m": (0, 0, 0), "length_m": 1, "width_m": 1}), RectangleFeature)
    assert isinstance(read({"type": "circle", "name": "c", "radius_m": 1}), CircleFeature)
    assert isinstance(read({"type": "marker", "name": "m", "shape": "square", "size_m": 0.1}), MarkerFeature)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"normal": (0, 0, 0)}, "must not be zero"),
        ({"x_axis": (0, 0, 0)}, "must not be zero"),
        ({"x_axis": (1, 0, 1)}, "must be perpendicular, their cosine is 0.707"),
        ({"radius_m": 0}, "greater than 0"),
    ],
)
def test_what_is_no_circle_is_refused(changes: dict, says: str):
    with pytest.raises(ValidationError, match=says):
        circle(**changes)


@pytest.mark.parametrize("changes", [{"shape": "triangle"}, {"size_m": -0.1}, {"radius_m": 0.1}])
def test_what_is_no_marker_is_refused(changes: dict):
    with pytest.raises(ValidationError):
        MarkerFeature.model_validate({"type": "marker", "name": "m", "shape": "disc", "size_m": 0.1} | changes)
