"""The paper's target: its parts fit together, and its features lie on them."""

import numpy as np
import pytest
from pydantic import ValidationError

from scenes.features import RectangleFeature
from scenes.scenario import load_scenario
from scenes.solids import solids
from scenes.target import Target
from scenes.wings import CubeWithWings

PAINT = {"type": "paint", "source": "test", "reflectance": 0.5}
MATERIALS = {"body_material": PAINT, "wing_material": PAINT, "yoke_material": PAINT}


@pytest.fixture(scope="module")
def target() -> Target:
    """As in the library."""
    return load_scenario("zhai2014-in-plane").target


def _feature(target: Target, name: str) -> RectangleFeature:
    return next(feature for feature in target.features if feature.name == name)


def _box(target: Target, name: str) -> tuple[np.ndarray, np.ndarray]:
    vertices = next(solid.vertices_target for solid in solids(target) if solid.name == name)
    return vertices.min(axis=0), vertices.max(axis=0)


def test_parts_touch_and_do_not_overlap(target: Target):
    body, wing, yoke, other = (_box(target, name) for name in ("body", "wing+y", "yoke+y", "wing-y"))
    assert body[0] == pytest.approx([-1.5] * 3)
    assert yoke[0][1] == pytest.approx(body[1][1])
    assert wing[0][1] == pytest.approx(yoke[1][1])
    assert wing[1] - wing[0] == pytest.approx([0.06, 10.0, 3.0])
    assert other[0] == pytest.approx([-0.03, -12.0, -1.5])
    assert other[1] == pytest.approx([0.03, -2.0, 1.5])


def test_features_lie_on_the_fronts_of_their_parts(target: Target):
    for feature, parts in (("face", ["body"]), ("wing", ["wing+y"]), ("span", ["wing+y", "wing-y"])):
        corners = _feature(target, feature).corners_target
        low, high = (np.array(ends) for ends in zip(*(_box(target, part) for part in parts)))
        assert corners[:, 0] == pytest.approx(np.full(4, high[:, 0].max()))
        assert corners[:, 1:].min(axis=0) == pytest.approx(low[:, 1:].min(axis=0))
        assert corners[:, 1:].max(axis=0) == pytest.approx(high[:, 1:].max(axis=0))


def test_corners_are_in_the_papers_order(target: Target):
    p1, p2, p3, p4 = _feature(target, "face").corners_target
    assert [p1[1:].tolist(), p2[1:].tolist(), p3[1:].tolist(), p4[1:].tolist()] == [
        [-1.5, -1.5],
        [1.5, -1.5],
        [-1.5, 1.5],
        [1.5, 1.5],
    ]
    assert _feature(target, "wing").target_from_feature.as_matrix() == pytest.approx(np.eye(3))  # X normal, Y length, Z width


def test_the_spans_gap_is_where_no_wing_is(target: Target):
    span = _feature(target, "span")
    gap_m = (np.array(span.gap) - 0.5) * span.length_m
    assert gap_m == pytest.approx([-2.0, 2.0])
    assert span.length_m == 24.0
    assert _feature(target, "face").gap is None


def test_thickness_and_yokes_are_parameters():
    lean = CubeWithWings.model_validate(
        {"type": "cube-with-wings", "wing_thickness_m": 0.01, "yoke_length_m": 1.0} | MATERIALS
    ).assembled()
    assert _box(lean, "wing+y")[0] == pytest.approx([-0.005, 2.5, -1.5])
    assert _feature(lean, "span").length_m == 25.0


@pytest.mark.parametrize("changes", [{"body_m": 0.0}, {"wing_length_m": -1.0}, {"wings": 2}])
def test_impossible_wings_are_refused(changes: dict):
    with pytest.raises(ValidationError):
        CubeWithWings.model_validate({"type": "cube-with-wings"} | MATERIALS | changes)
