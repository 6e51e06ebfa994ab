"""Inertia: its basis, what no body can have, principal axes and their 24 labellings."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from scenes.inertia import (
    BASIS,
    MassProperties,
    components_of,
    inertia_of,
    infeasibility,
    is_feasible,
    labelled_nearest,
    principal_axes,
    relabellings,
)

PAPER = (500.0, 1000.0, 1500.0)  # Song et al. 2017, section 5.1


def _some_inertia(seed: int) -> np.ndarray:
    """Of a random body: a sum over point masses, so feasible."""
    points = np.random.default_rng(seed).normal(size=(20, 3)) * [1.0, 2.0, 0.5]
    return np.einsum("ni,ni->", points, points) * np.eye(3) - points.T @ points


def test_the_basis_is_orthonormal_traceless_and_symmetric():
    np.testing.assert_allclose(np.einsum("aij,bij->ab", BASIS, BASIS), np.eye(5), atol=1e-15)
    np.testing.assert_allclose(np.trace(BASIS, axis1=1, axis2=2), 0.0, atol=1e-15)
    assert np.array_equal(BASIS, np.swapaxes(BASIS, 1, 2))
    assert [tuple(np.argwhere(matrix)[0]) for matrix in BASIS[2:]] == [(0, 1), (0, 2), (1, 2)]  # xy, xz, yz


@pytest.mark.parametrize("seed", range(4))
def test_components_and_back(seed: int):
    inertia = _some_inertia(seed)
    scaled = inertia * 3 / np.trace(inertia)
    np.testing.assert_allclose(inertia_of(components_of(inertia)), scaled, atol=1e-14)
    j = np.random.default_rng(seed).normal(size=(7, 5)) * 0.3
    np.testing.assert_allclose(components_of(inertia_of(j)), j, atol=1e-14)
    np.testing.assert_allclose(np.trace(inertia_of(j), axis1=1, axis2=2), 3.0, atol=1e-14)


@pytest.mark.parametrize("factor", [1e-6, 7.0, 1e9])
def test_a_factor_is_not_seen(factor: float):
    np.testing.assert_allclose(components_of(factor * _some_inertia(0)), components_of(_some_inertia(0)), atol=1e-14)


def test_a_lamina_is_allowed_and_the_papers_guess_is_not():
    assert is_feasible(PAPER)
    assert is_feasible((0.1, 0.2, 0.1 + 0.2))
    assert infeasibility((1.0, 3.0, 4.5)) == (  # 150 % of p = (2, 3)
        "no body has the principal moments of inertia 1, 3, 4.5: the largest, 4.5, exceeds the others' sum, 4"
    )
    assert not is_feasible((4.5, 3.0, 1.0))
    assert not is_feasible((1.0, 2.0, 3.001))
    assert "each must be positive" in infeasibility((0.0, 1.0, 1.0))
    assert "each must be positive" in infeasibility((-1.0, 5.0, 5.0))


def test_a_spec_refuses_what_no_body_has():
    with pytest.raises(ValidationError, match=r"principal_kg_m2: no body has .* 500, 1500, 2250: the largest, 2250, exceeds"):
        MassProperties(principal_kg_m2=(500.0, 1500.0, 2250.0))
    assert MassProperties(principal_kg_m2=PAPER).inertia_target == pytest.approx(np.diag(PAPER))


def test_the_inertia_of_a_spec_is_turned_into_the_target_frame():
    mass = MassProperties(principal_kg_m2=PAPER, centre_of_mass_m=(1.0, 2.0, 3.0), quaternion_wxyz=(0.5, 0.5, 0.5, 0.5))
    assert mass.target_from_body.apply([1.0, 0.0, 0.0]) == pytest.approx([1.0, 3.0, 3.0])  # x of the body is y of the target
    assert mass.inertia_target == pytest.approx(np.diag([1500.0, 500.0, 1000.0]), abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_principal_axes_are_proper_and_give_the_inertia_back(seed: int):
    inertia = _some_inertia(seed)
    moments, axes = principal_axes(inertia)
    matrix = axes.as_matrix()
    assert (np.diff(moments) > 0).all()
    np.testing.assert_allclose(matrix @ np.diag(moments) @ matrix.T, inertia, rtol=1e-12, atol=1e-12)
    assert np.linalg.det(matrix) == pytest.approx(1.0)


def test_there_are_24_labellings_and_they_form_a_group():
    group = relabellings()
    assert group.shape == (24, 3, 3)
    assert np.array_equal(group[0], np.eye(3))
    members = {matrix.tobytes() for matrix in group + 0.0}
    assert len(members) == 24
    assert {(a @ b + 0.0).tobytes() for a in group for b in group} == members


@pytest.mark.parametrize("place", range(24))
def test_a_relabelled_truth_is_found_again(place: int):
    """Whatever order and signs the truth's axes have, an estimate near it comes back with the truth's ratios and axes."""
    moments, truth = np.array(PAPER), Rotation.random(rng=np.random.default_rng(5))
    change = relabellings()[place]
    relabelled, axes = np.abs(change) @ moments, truth * Rotation.from_matrix(change.T)
    matrix = axes.as_matrix()
    off = Rotation.from_rotvec([0.02, -0.01, 0.03])
    estimate = off.as_matrix() @ matrix @ np.diag(relabelled) @ matrix.T @ off.as_matrix().T
    p1, p2, found = labelled_nearest(relabelled, axes, 0.01 * estimate)
    assert (p1, p2) == pytest.approx((relabelled[1] / relabelled[0], relabelled[2] / relabelled[0]))
    assert (found * (off * axes).inv()).magnitude() < 1e-7


def test_between_two_labellings_the_moments_decide():
    """Axes 46 deg off are nearer to the neighbours' places by angle; the moments say that it is a poor estimate, not a swap."""
    off = Rotation.from_rotvec([0.0, 0.0, 46.0], degrees=True)
    estimate = off.as_matrix() @ np.diag(PAPER) @ off.as_matrix().T
    p1, p2, axes = labelled_nearest(PAPER, Rotation.identity(), estimate)
    assert (p1, p2) == pytest.approx((2.0, 3.0))
    assert np.degrees(axes.magnitude()) == pytest.approx(46.0)
    alike = labelled_nearest((1.0, 1.0, 1.5), Rotation.identity(), off.as_matrix() @ np.diag([1.0, 1.001, 1.5]) @ off.as_matrix().T)
    assert np.degrees(alike[2].magnitude()) == pytest.approx(44.0, abs=0.01)  # equal moments have no say


def test_an_estimate_that_no_body_has_still_gets_labels():
    p1, p2, axes = labelled_nearest(PAPER, Rotation.identity(), np.diag([-0.1, 1.0, 2.1]))
    assert (p1, p2) == pytest.approx((-10.0, -21.0))
    assert axes.magnitude() < 1e-12
