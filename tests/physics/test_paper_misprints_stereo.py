"""What comes of following the print of Shu et al. 2020 where nothing else shows it: the papers' page names these tests."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.stereo_ring.circle_cone import cones_of_conics, conics_of_circles, normals_of_cones
from estimators.stereo_ring.conics import conics_from_parameters
from estimators.stereo_ring.regions import fill_and_aspect
from estimators.stereo_ring.rig import Rig, project

FOCAL_PX, COUNT = 1024 / np.tan(np.radians(30)), 4000
K = np.array([[FOCAL_PX, 0, 1023.5], [0, FOCAL_PX, 1023.5], [0, 0, 1]])
TURN = Rotation.from_euler("y", 36, degrees=True)  # each camera 18° inwards
RIG = Rig(K, K, RigidTransform.from_components([-1.3 * np.cos(np.pi / 10), 0, 1.3 * np.sin(np.pi / 10)], TURN))


def crossed(v: np.ndarray) -> np.ndarray:
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def angle_deg(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(one, other), axis=-1), np.sum(one * other, axis=-1)))


def homogeneous(pixels: np.ndarray) -> np.ndarray:
    return np.concatenate([pixels, np.ones((len(pixels), 1))], axis=1)


def some_points() -> np.ndarray:
    """In left axes, 3 to 10 m in front of the rig."""
    rng = np.random.default_rng(1)
    z = rng.uniform(3, 10, COUNT)
    in_rig = np.stack([rng.uniform(-0.2, 0.2, COUNT) * z, rng.uniform(-0.2, 0.2, COUNT) * z, z], axis=1)
    in_rig[:, 0] += 0.65
    return Rotation.from_euler("y", -18, degrees=True).apply(in_rig)


def circles() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Normals (n, 3) in left axes of rings that both cameras see from the front, and their conics in both views."""
    centres = some_points()
    normals = Rotation.random(COUNT, rng=np.random.default_rng(2)).as_matrix()[:, 0]
    normals *= -np.sign(np.sum(normals * centres, axis=1, keepdims=True))
    other = np.sum((normals @ RIG.R.T) * (centres @ RIG.R.T + RIG.T), axis=1)
    keep = (np.sum(normals * centres, axis=1) < -0.5) & (other < -0.5)
    left, right = (conics_of_circles(centres, normals, np.full(COUNT, 0.6), one)[keep] for one in RIG.projections)
    return normals[keep], left, right


def off_lines_px(F: np.ndarray) -> np.ndarray:
    """How far the right images of points are from the lines F p_l of their left images."""
    left, right = (homogeneous(one) for one in project(RIG, some_points()))
    lines = left @ F.T
    return np.abs(np.sum(right * lines, axis=1)) / np.linalg.norm(lines[:, :2], axis=1)


def test_an_epipole_matches_everything():
    F = np.linalg.inv(K).T @ crossed(RIG.T) @ RIG.R @ np.linalg.inv(K)
    e_l = K @ -(RIG.R.T @ RIG.T)  # the right camera, seen from the left one
    scale = np.linalg.norm(F) * np.linalg.norm(e_l)
    assert np.abs(F @ e_l).max() / scale < 1e-14  # its line is 0 = 0
    others = homogeneous(np.random.default_rng(3).uniform(0, 2047, (COUNT, 2)))
    assert np.abs(others @ F @ e_l).max() / scale < 1e-10


def test_eq_2_in_the_printed_order_is_tens_of_pixels_off():
    back = np.linalg.inv(K)
    assert off_lines_px(back.T @ crossed(RIG.T) @ RIG.R @ back).max() < 1e-8
    assert np.median(off_lines_px(back.T @ RIG.R @ crossed(RIG.T) @ back)) == pytest.approx(24, abs=2)
    centre = -(RIG.R.T @ RIG.T)  # the order is right for the right camera's centre in the left frame
    assert off_lines_px(back.T @ RIG.R @ crossed(centre) @ back).max() < 1e-8


def some_ellipses() -> tuple[np.ndarray, np.ndarray]:
    """Parameters (n, 5) and coefficients A..F of eq. (3), A + C > 0."""
    rng = np.random.default_rng(4)
    a = rng.uniform(50, 600, COUNT)
    truth = np.stack(
        [*rng.uniform(0, 2047, (2, COUNT)), a, a * rng.uniform(0.2, 0.95, COUNT), rng.uniform(-1.5, 1.5, COUNT)], axis=1
    )
    C = conics_from_parameters(truth)
    C = C * np.sign(C[:, 0, 0] + C[:, 1, 1])[:, None, None]
    return truth, np.stack([C[:, 0, 0], 2 * C[:, 0, 1], C[:, 1, 1], 2 * C[:, 0, 2], 2 * C[:, 1, 2], C[:, 2, 2]])


def eq_5(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, E: np.ndarray, F: np.ndarray) -> np.ndarray:
    """x0, y0, a, b as printed."""
    x0, y0 = (B * E - 2 * C * D) / (4 * A * C - B**2), (B * D - 2 * A * E) / (4 * A * C - B**2)
    top, root = 2 * (A * x0**2 + C * y0**2 + B * x0 * y0 - F), np.hypot(A - C, B)
    return np.stack([x0, y0, np.sqrt(top / (A + C - root)), np.sqrt(top / (A + C + root))], axis=1)


def test_eq_5_needs_the_d_of_eq_3():
    truth, (A, B, C, D, E, F) = some_ellipses()
    assert eq_5(A, B, C, D, E, F) == pytest.approx(truth[:, :4], rel=1e-6)
    with np.errstate(invalid="ignore"):
        without = eq_5(A, B, C, 0 * D, E, F)
    assert np.median(np.linalg.norm(without[:, :2] - truth[:, :2], axis=1)) > 100


def test_eq_5_takes_b_for_a_where_a_conic_has_the_other_sign():
    truth, coefficients = some_ellipses()
    found = eq_5(*(-coefficients))
    assert found[:, :2] == pytest.approx(truth[:, :2], rel=1e-6)
    assert found[:, [3, 2]] == pytest.approx(truth[:, 2:4], rel=1e-6)


def test_eq_6_with_the_number_of_regions_refuses_every_marker():
    full, _ = fill_and_aspect(20.0 * 20.0, 20.0, 20.0, 1)
    printed, _ = fill_and_aspect(4.0, 20.0, 20.0, 1)
    assert full == pytest.approx(1.0)
    assert printed == pytest.approx(0.01)
    sides = np.sqrt(np.arange(200.0, 3001.0))  # the printed areas
    assert np.max(4 / sides**2) < 0.5  # the printed limit


def ordered(Q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues (n, 3), largest first, and the eigenvectors (n, 3, 3) as columns."""
    values, vectors = np.linalg.eigh((Q + np.swapaxes(Q, -1, -2)) / 2)
    return values[:, ::-1], vectors[..., ::-1]


def test_the_cone_needs_its_sign_for_the_centre():
    """With (+, +, −) a plane's section has −cᵀ Q c / λ2 for its squared radius; with the other sign it is negative."""
    normals, left, _ = circles()
    Q = cones_of_conics(left, K)
    values, _ = ordered(Q)
    assert ((values[:, 1] > 0) & (values[:, 2] < 0)).all()
    for cone, share in ((Q, 0.0), (-Q, 1.0)):
        middle = ordered(cone)[0][:, 1]
        centre = np.linalg.solve(cone, normals[..., None])[..., 0]
        centre /= np.sum(normals * centre, axis=1, keepdims=True)
        squared = -np.einsum("ni,nij,nj->n", centre, cone, centre) / np.abs(middle)
        assert np.mean(squared < 0) == share


def test_eq_11_as_printed_has_other_normals():
    normals, left, _ = circles()
    values, vectors = ordered(cones_of_conics(left, K))
    l1, l2, l3 = values.T
    found = []
    for first in ((l1 - l2) / (l1 - l3), np.ones_like(l1)):
        both = [
            np.sqrt(first)[:, None] * vectors[..., 0] + sign * np.sqrt((l2 - l3) / (l1 - l3))[:, None] * vectors[..., 2]
            for sign in (1, -1)
        ]
        off = [np.minimum(angle_deg(one, normals), angle_deg(-one, normals)) for one in both]
        found.append(np.min(off, axis=0))
    assert found[0].max() < 1e-6
    assert np.median(found[1]) == pytest.approx(5.6, abs=0.5)
    assert np.percentile(found[1], 95) > 20


def test_normals_are_paired_after_they_face_the_camera():
    normals, left, right = circles()
    signs = np.where(np.random.default_rng(5).random((2, len(normals), 2, 1)) < 0.5, 1.0, -1.0)
    shares = []
    for flip in (np.ones_like(signs), signs):
        one = normals_of_cones(cones_of_conics(left, K)) * flip[0]
        other = (normals_of_cones(cones_of_conics(right, K)) * flip[1]) @ RIG.R
        gaps = np.linalg.norm(one[:, :, None] - other[:, None], axis=-1).reshape(-1, 4)
        sums = (one[:, :, None] + other[:, None]).reshape(-1, 4, 3)
        chosen = np.take_along_axis(sums, gaps.argmin(axis=1)[:, None, None], axis=1)[:, 0]
        off = angle_deg(chosen, normals)
        shares.append(np.mean(np.minimum(off, 180 - off) > 1))
    assert shares[0] == 0
    assert shares[1] == pytest.approx(0.49, abs=0.03)


def test_eq_13_as_printed_is_no_rotation():
    b0, b1 = np.array([0.0, 0.0, 5.0]), np.array([1.0, 0.0, 5.0])
    for turn_deg, length in ((30.0, 0.5), (90.0, 1.0), (-30.0, 0.5)):
        b2 = b0 + np.array([np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg)), 0.0])
        printed = np.cross(b1 - b0, (b2 - b0) / np.linalg.norm(b2 - b0))
        assert np.linalg.norm(printed) == pytest.approx(length)
        assert (printed @ b0 < 0) == (turn_deg < 0)  # whether it looks at the camera is the markers' order
