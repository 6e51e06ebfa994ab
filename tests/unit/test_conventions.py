"""CONVENTIONS.md says it to users; here the code is held to it."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.predictions import COLUMNS
from estimators.api import Outcome
from renderer.masks import Light
from scenes.dataset_layout import TRUTH_COLUMNS
from scenes.motion import CHASER_FROM_PAPER, AxisSweep
from scenes.pose_columns import pose_columns
from scenes.scenario import load_scenario

QUARTER_DEG = 30.0
C, S = np.cos(np.radians(QUARTER_DEG)), np.sin(np.radians(QUARTER_DEG))
PASSIVE = {
    "x": np.array([[1, 0, 0], [0, C, S], [0, -S, C]]),
    "y": np.array([[C, 0, -S], [0, 1, 0], [S, 0, C]]),
    "z": np.array([[C, S, 0], [-S, C, 0], [0, 0, 1]]),
}


@pytest.fixture(scope="module")
def page(repository: Path) -> str:
    return (repository / "CONVENTIONS.md").read_text(encoding="utf-8")


def swept(axis: str, angle_deg: float) -> RigidTransform:
    sweep = AxisSweep(type="axis-sweep", axis=axis, start_deg=angle_deg, rate_deg_s=0.0, range_m=100.0)
    return sweep.chaser_from_target(0.0, 0, 0)


@pytest.mark.parametrize("axis", "xyz")
def test_a_sweep_follows_the_papers_passive_matrices(axis):
    np.testing.assert_allclose(swept(axis, QUARTER_DEG).rotation.as_matrix(), CHASER_FROM_PAPER @ PASSIVE[axis], atol=1e-15)


def test_a_positive_angle_faces_up_about_y_and_left_about_z():
    normal = np.array([1.0, 0.0, 0.0])
    np.testing.assert_allclose(swept("y", QUARTER_DEG).rotation.apply(normal), [0, -S, -C], atol=1e-15)  # y down: up is −
    np.testing.assert_allclose(swept("z", QUARTER_DEG).rotation.apply(normal), [-S, 0, -C], atol=1e-15)


def test_corners_in_z_order_lie_as_drawn():
    scenario = load_scenario("zhai2014-in-plane")
    lens = scenario.cameras["nav"].intrinsics
    for feature in scenario.target.features:
        p1, p2, p3, p4 = lens.project(swept("y", 0.0).apply(feature.corners_target))
        assert p1[0] < p2[0]
        assert p3[0] < p4[0]  # left, right
        assert min(p1[1], p2[1]) > max(p3[1], p4[1])  # bottom, top: v grows downwards


def test_the_image_centre_looks_along_the_axis():
    lens = load_scenario("zhai2014-in-plane").cameras["nav"].intrinsics
    centre = ((lens.width_px - 1) / 2, (lens.height_px - 1) / 2)
    np.testing.assert_allclose(lens.rays(centre), [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(lens.project([1.0, 0.0, 10.0]), [lens.fx_px / 10 + centre[0], centre[1]])


@pytest.mark.parametrize("seed", range(8))
def test_quaternions_are_scalar_first_and_not_negative(seed):
    rotation = Rotation.random(rng=np.random.default_rng(seed))
    columns = pose_columns(RigidTransform.from_components([1, 2, 3], rotation))
    x, y, z, w = rotation.as_quat()
    sign = 1 if w >= 0 else -1
    expected = [sign * value for value in (w, x, y, z)] + [1, 2, 3]
    np.testing.assert_allclose(list(columns.values()), expected, atol=1e-15)
    assert list(columns) == ["qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m"]


def test_the_page_names_every_mask_bit_column_and_outcome(page):
    rows = dict(re.findall(r"^\| (\d+) \| `(\w+)`", page, re.MULTILINE))
    assert {int(bit): name for bit, name in rows.items()} == {int(bit): bit.name.lower() for bit in Light}
    assert f"`{','.join(COLUMNS)}`" in page
    assert f"`{' '.join(outcome.value for outcome in Outcome)}`" in page
    words = set(re.findall(r"\w+", page))
    assert set(TRUTH_COLUMNS) <= words


def test_the_matrix_on_the_page_is_the_one_in_the_code(page):
    rows = re.search(r"P_cam = \|(.+?)\|.*\n\s*\|(.+?)\| P_C.*\n\s*\|(.+?)\|", page)
    matrix = [[int(cell.replace("−", "-")) for cell in row.split()] for row in rows.groups()]
    np.testing.assert_array_equal(matrix, CHASER_FROM_PAPER)
