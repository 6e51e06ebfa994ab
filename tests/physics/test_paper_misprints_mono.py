"""What comes of following the print of Zhai et al. 2014 where nothing else shows it: the papers' page names these tests."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from estimators.mono_rectangle.angles import rotation_from_zyx, zyx_from_rotation
from estimators.mono_rectangle.paper_form import PAPER_FROM_CV

COUNT = 20_000


def angle_deg(A: np.ndarray, B: np.ndarray) -> np.ndarray:
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(A - B, axis=(-2, -1)) / np.sqrt(8), 0, 1)))


def visible_attitudes() -> np.ndarray:
    """R_ct of faces that look at the camera: X points backward, so R11 > 0."""
    R = PAPER_FROM_CV @ Rotation.random(3 * COUNT, rng=np.random.default_rng(1)).as_matrix()
    return R[R[:, 0, 0] > 0.01][:COUNT]


def test_the_sequence_as_printed_turns_the_sweep_round():
    """Read from the camera to the target, R_ct would be its transpose."""
    R_ct = rotation_from_zyx([0.0, np.radians(30.0), 0.0])
    assert np.degrees(zyx_from_rotation(R_ct.T))[1] == pytest.approx(-30.0)
    assert angle_deg(R_ct.T, R_ct) == pytest.approx(60.0)


def test_arctan_of_a_ratio_loses_half_of_the_attitudes():
    R = visible_attitudes()
    angles = np.stack([np.arctan(R[:, 0, 1] / R[:, 0, 0]), np.arcsin(-R[:, 0, 2]), np.arctan(R[:, 1, 2] / R[:, 2, 2])], axis=1)
    off = angle_deg(rotation_from_zyx(angles), R)
    assert np.mean(off > 1) == pytest.approx(0.5, abs=0.03)
    assert np.median(off[off > 1]) == pytest.approx(180, abs=0.1)
    assert angle_deg(rotation_from_zyx(zyx_from_rotation(R)), R).max() < 1e-6


def test_the_pole_is_missed_by_an_equality():
    """Attitudes at θ2 = ±90°, as they come out of a product: R11, R12 are what rounding left of zero."""
    rng = np.random.default_rng(2)
    ahead, behind = Rotation.random(2 * COUNT, rng=rng)[:COUNT], Rotation.random(COUNT, rng=rng)
    angles = np.stack([rng.uniform(-3, 3, COUNT), rng.choice([-1, 1], COUNT) * np.pi / 2, np.zeros(COUNT)], axis=1)
    R = (ahead * (behind * (behind.inv() * (ahead.inv() * Rotation.from_matrix(rotation_from_zyx(angles)))))).as_matrix()
    assert np.abs(np.abs(R[:, 0, 2]) - 1).max() < 1e-14
    missed = np.abs(R[:, 0, 2]) != 1
    assert missed.mean() > 0.5
    assert np.hypot(R[missed, 0, 0], R[missed, 0, 1]).max() < 1e-7
    printed = np.stack([np.arctan2(R[:, 0, 1], R[:, 0, 0]), np.zeros(COUNT)], axis=1)[missed]  # θ1 of the other branch: of noise
    right = zyx_from_rotation(R)[missed]
    assert np.all(right[:, 2] == 0)
    apart = np.degrees(np.abs((printed[:, 0] - right[:, 0] + np.pi) % (2 * np.pi) - np.pi))
    assert np.median(apart) > 30


def test_the_printed_radius_is_the_width():
    width_m = 2 * 100 * np.tan(np.radians(15))
    assert width_m == pytest.approx(53.59, abs=0.005)
    field_deg = 2 * np.degrees(np.arctan(53.59 / 100))
    assert field_deg == pytest.approx(56.4, abs=0.05)  # what a radius of 53.59 m would need
    assert np.tan(np.radians(15)) / np.tan(np.radians(field_deg / 2)) == pytest.approx(0.5, abs=1e-3)


def test_the_printed_mean_can_only_be_signed():
    """721 normal errors whose largest is 3° have a mean magnitude near 0.7°; their signed mean is 0.03° or so off zero."""
    errors = np.random.default_rng(3).normal(size=(2000, 721))
    errors *= 3.0 / np.abs(errors).max(axis=1, keepdims=True)
    assert np.abs(errors).mean(axis=1).mean() == pytest.approx(0.72, abs=0.02)
    assert np.abs(errors).mean(axis=1).min() > 0.4
    assert np.abs(errors.mean(axis=1)).mean() < 0.05
