"""Draws and their streams: distributions, and that one draw never disturbs another."""

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError
from scipy import stats

from scenes.draw import Direction, LogUniform, Normal, OnSphere, PositiveScalar, Scalar, Uniform, direction, scalar
from scenes.provenance import stream

SCALAR, DIRECTION = TypeAdapter(Scalar), TypeAdapter(Direction)


def _values(draw: Uniform | LogUniform | Normal, count: int = 4000) -> np.ndarray:
    return np.array([scalar(draw, stream(5, frame, "field")) for frame in range(count)])


def test_a_plain_number_is_itself_and_uses_no_randomness():
    rng = np.random.default_rng(0)
    before = rng.bit_generator.state
    assert scalar(3.5, rng) == 3.5
    assert direction((0.0, 3.0, 4.0), rng) == pytest.approx([0.0, 0.6, 0.8])
    assert rng.bit_generator.state == before


@pytest.mark.parametrize(
    ("draw", "law"),
    [
        (Uniform(draw="uniform", low=-2.0, high=5.0), stats.uniform(-2, 7)),
        (LogUniform(draw="log-uniform", low=0.1, high=100.0), stats.loguniform(0.1, 100)),
        (Normal(draw="normal", mean=3.0, sigma=0.5), stats.norm(3, 0.5)),
    ],
)
def test_draws_over_frames_follow_their_law(draw: Uniform | LogUniform | Normal, law):
    values = _values(draw)
    assert stats.kstest(values, law.cdf).pvalue > 1e-3
    # Streams of successive frames are independent: no correlation at lag one.
    assert abs(np.corrcoef(values[:-1], values[1:])[0, 1]) < 4 / np.sqrt(len(values))


def test_on_sphere_is_uniform():
    vectors = np.array([direction(OnSphere(draw="on-sphere"), stream(1, frame, "d")) for frame in range(6000)])
    assert np.abs(np.linalg.norm(vectors, axis=1) - 1).max() < 1e-12
    assert np.abs(vectors.mean(axis=0)).max() < 4 / np.sqrt(3 * 6000)
    assert np.abs(vectors.T @ vectors / 6000 - np.eye(3) / 3).max() < 0.02
    for axis in range(3):  # Archimedes: each coordinate is uniform on [−1, 1]
        assert stats.kstest(vectors[:, axis], stats.uniform(-1, 2).cdf).pvalue > 1e-3


@pytest.mark.parametrize("about", [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, -2.0, 0.5), (1e-9, 0.0, -1.0)])
def test_a_cap_is_uniform_about_its_axis(about: tuple[float, float, float]):
    cap = OnSphere(draw="on-sphere", about=about, within_deg=25.0)
    vectors = np.array([direction(cap, stream(2, frame, "d")) for frame in range(3000)])
    axis = np.array(about) / np.linalg.norm(about)
    cos = vectors @ axis
    assert cos.min() >= np.cos(np.radians(25.0)) - 1e-12
    assert stats.kstest(cos, stats.uniform(np.cos(np.radians(25)), 1 - np.cos(np.radians(25))).cdf).pvalue > 1e-3
    aside = vectors - cos[:, None] * axis
    assert np.abs(aside.mean(axis=0)).max() < 0.02  # no side is preferred


def test_a_cap_of_no_width_is_its_axis():
    cap = OnSphere(draw="on-sphere", about=(0.0, 2.0, 0.0), within_deg=0.0)
    assert direction(cap, stream(0, 0, "d")) == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)


def test_a_stream_belongs_to_seed_frame_and_path():
    one = stream(7, 3, "motion.range_m").random(8)
    assert np.array_equal(one, stream(7, 3, "motion.range_m").random(8))
    for other in (stream(8, 3, "motion.range_m"), stream(7, 4, "motion.range_m"), stream(7, 3, "motion.right_deg")):
        assert not np.isin(one, other.random(8)).any()


@pytest.mark.parametrize(
    ("tree", "says"),
    [
        ({"draw": "uniform", "low": 2.0, "high": 1.0}, "high 1.0 lies below low 2.0"),
        ({"draw": "log-uniform", "low": 2.0, "high": 1.0}, "high 1.0 lies below low 2.0"),
        ({"draw": "log-uniform", "low": 0.0, "high": 1.0}, "greater than 0"),
        ({"draw": "normal", "mean": 0.0, "sigma": -1.0}, "greater than or equal to 0"),
        ({"draw": "beta", "a": 1.0}, "beta"),
        (float("inf"), "finite"),
    ],
)
def test_impossible_draws_are_refused(tree, says: str):
    with pytest.raises(ValidationError, match=says):
        # A bare adapter has no model's configuration, so finiteness is asked of a field.
        TypeAdapter(Scalar, config={"allow_inf_nan": False}).validate_python(tree)


@pytest.mark.parametrize(
    "field", [1.0, {"draw": "uniform", "low": 0.1, "high": 0.2}, {"draw": "normal", "mean": 1.0, "sigma": 0.1}]
)
def test_positive_fields_take_what_stays_positive(field):
    TypeAdapter(PositiveScalar).validate_python(field)


@pytest.mark.parametrize(
    "field", [0.0, -1.0, {"draw": "uniform", "low": 0.0, "high": 0.2}, {"draw": "normal", "mean": 1.0, "sigma": 0.2}]
)
def test_positive_fields_refuse_what_may_not(field):
    with pytest.raises(ValidationError, match="must be greater than 0"):
        TypeAdapter(PositiveScalar).validate_python(field)


def test_a_direction_has_a_length():
    with pytest.raises(ValidationError, match="zero vector"):
        DIRECTION.validate_python((0.0, 0.0, 0.0))
    with pytest.raises(ValidationError, match="zero vector"):
        OnSphere(draw="on-sphere", about=(0.0, 0.0, 0.0))
    assert SCALAR.validate_python(3) == 3
