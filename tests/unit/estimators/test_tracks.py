"""Filters and memories against theory: consistency, invariance, the gain that white noise allows."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from estimators.mono_rectangle import attitude_filter, vertex_track
from estimators.mono_rectangle.aspect_memory import AspectMemory
from estimators.mono_rectangle.attitude_filter import AttitudeSample
from estimators.mono_rectangle.attitude_track import AttitudeTrack
from estimators.mono_rectangle.labels import nearest_label, quarter_turn
from estimators.mono_rectangle.parameters import TrackedParameters
from estimators.mono_rectangle.quadrilateral import EDGES, edge_ends, edge_normals, intersections
from estimators.mono_rectangle.robust_line import robust_line
from estimators.mono_rectangle.solution import Solution

QUAD = np.array([[40.0, 90.0], [160.0, 88.0], [42.0, 30.0], [158.0, 33.0]])
RATE_RAD_S = np.deg2rad(0.1)


def samples(count, sigma_rad, seed, dt=1.0, axis=(0.2, 0.9, 0.3)):
    """A constant rate about a slanted axis, measured with anisotropic noise in camera axes."""
    rng = np.random.default_rng(seed)
    omega = RATE_RAD_S * np.array(axis) / np.linalg.norm(axis)
    start = Rotation.from_rotvec([0.3, -0.2, 0.1])
    true = [Rotation.from_rotvec(omega * dt * i) * start for i in range(count)]
    sd = sigma_rad * np.array([1.0, 1.0, 0.1])
    measured = [Rotation.from_rotvec(rng.normal(0, sd)) * r for r in true]
    return true, [AttitudeSample(dt * i, m, np.diag(sd**2)) for i, m in enumerate(measured)]


def filtered(measured, q, start=5):
    state = attitude_filter.line_through(measured[:start])
    states = [state]
    for sample in measured[start:]:
        state = attitude_filter.updated(attitude_filter.predicted(state, sample.time_s, q), sample)
        states.append(state)
    return states


def test_a_line_through_exact_rotations_is_exact():
    true, measured = samples(6, 1e-4, 0)
    exact = [replace(s, rotation=t) for s, t in zip(measured, true, strict=True)]
    state = attitude_filter.line_through(exact)
    assert (state.rotation * true[-1].inv()).magnitude() < 1e-12
    assert np.linalg.norm(state.rate_rad_s) == pytest.approx(RATE_RAD_S, rel=1e-9)


def test_white_noise_falls_six_to_nine_fold():
    """The wing at 1 Hz, q = 1e-8 deg²/s³, after 60 s."""
    raw, kept = [], []
    for seed in range(6):
        true, measured = samples(600, np.deg2rad(0.8), seed)
        states = filtered(measured, np.deg2rad(1.0) ** 2 * 1e-8)
        raw += [(m.rotation * t.inv()).as_rotvec()[:2] for m, t in zip(measured[60:], true[60:], strict=True)]
        kept += [(s.rotation * t.inv()).as_rotvec()[:2] for s, t in zip(states[56:], true[60:], strict=True)]
    gain = np.std(raw) / np.std(kept)
    assert 6 < gain < 9


def test_the_filter_is_consistent():
    """Normalised estimation error squared of (φ, ω) over many runs lies in its χ² interval (Bar-Shalom et al. 2001, § 5.4)."""
    squares = []
    for seed in range(60):
        true, measured = samples(40, np.deg2rad(0.3), seed)
        state = filtered(measured, 1e-22)[-1]
        omega = (true[1] * true[0].inv()).as_rotvec()
        error = np.concatenate([(true[-1] * state.rotation.inv()).as_rotvec(), omega - state.rate_rad_s])
        squares.append(error @ np.linalg.solve(state.covariance, error))
    assert np.mean(squares) == pytest.approx(6, abs=4 * np.sqrt(12 / 60))


def test_the_filter_knows_no_preferred_axes():
    """Turning the camera turns the estimate and its covariance with it."""
    _, measured = samples(30, np.deg2rad(0.3), 1)
    turn = Rotation.from_euler("xyz", [20, -40, 70], degrees=True)
    Q = turn.as_matrix()
    turned = [AttitudeSample(s.time_s, turn * s.rotation, Q @ s.covariance @ Q.T) for s in measured]
    one, two = filtered(measured, 1e-12)[-1], filtered(turned, 1e-12)[-1]
    assert (turn * one.rotation * two.rotation.inv()).magnitude() < 1e-12
    assert two.rate_rad_s == pytest.approx(Q @ one.rate_rad_s, abs=1e-14)


def test_a_time_that_goes_back_is_taken_for_now():
    _, measured = samples(6, 1e-3, 0)
    state = attitude_filter.line_through(measured)
    assert attitude_filter.predicted(state, -5.0, 1e-9).time_s == state.time_s


def test_the_track_refuses_an_outlier_and_starts_over_one_at_the_beginning():
    _, measured = samples(40, np.deg2rad(0.3), 2)
    bad = replace(measured[20], rotation=Rotation.from_rotvec([0.05, 0, 0]) * measured[20].rotation)
    track = AttitudeTrack(TrackedParameters())
    verdicts = [track.take(bad if i == 20 else s) for i, s in enumerate(measured)]
    assert "sigma from the prediction" in verdicts[20].reason
    assert sum(bool(v.reason) for v in verdicts) <= 2
    wrong_start = replace(measured[1], rotation=Rotation.from_rotvec([0.2, 0, 0]) * measured[1].rotation)
    track = AttitudeTrack(TrackedParameters())
    for i, sample in enumerate(measured[:12]):
        track.take(wrong_start if i == 1 else sample)
        assert i >= 6 or track.state is None
    assert track.state is not None


def test_a_track_holds_one_label():
    """Once started, a relabelled measurement (k = 0..3) is brought back to the track's label."""
    _, measured = samples(30, np.deg2rad(0.2), 3)
    track = AttitudeTrack(TrackedParameters())
    for sample in measured[:8]:
        track.take(sample)
    for i, sample in enumerate(measured[8:20]):
        relabelled = replace(sample, rotation=sample.rotation * quarter_turn(i))
        verdict = track.take(relabelled)
        assert not verdict.reason
        assert verdict.k == -i % 4
        assert (verdict.sample.rotation * sample.rotation.inv()).magnitude() < 1e-12


def test_labels_between_two_are_not_clear():
    between = Rotation.from_rotvec([np.deg2rad(44), 0, 0])
    choice = nearest_label(between, Rotation.identity())
    assert np.rad2deg(choice.angle_rad) == pytest.approx(44)
    assert np.rad2deg(choice.margin_rad) == pytest.approx(2)


def test_vertices_follow_a_constant_velocity_and_a_hidden_edge_the_others():
    """All edges seen for a while, then three: the fourth is carried along a common motion of shift and stretch."""
    velocity = np.array([0.3, -0.1]) + 0.002 * (QUAD - QUAD.mean(axis=0))
    track = vertex_track.started(QUAD + 0.5, 3.0, 0.0026)
    for step in range(1, 40):
        track = vertex_track.predicted(track, 1.0, 1e-5, 3.0)
        true = QUAD + step * velocity
        ends = edge_ends(true)
        for edge in range(4):
            if edge == 1 and step > 12:
                continue
            normal = edge_normals(ends[edge], true.mean(axis=0))
            track = vertex_track.updated(track, edge, ends[edge], normal, 0.05**2 * np.eye(2))
    assert np.abs(track.vertices_px - true).max() < 0.3
    normal = edge_normals(ends[1], true.mean(axis=0))
    hidden, seen = (np.sqrt(track.line_covariance(e, normal if e else -normal).max()) for e in (1, 0))
    assert hidden > 2 * seen
    _, squared = vertex_track.line_innovation(track, 1, ends[1], normal, 0.05**2 * np.eye(2))
    assert squared < 9


def test_the_vertex_track_is_consistent():
    rng, squares = np.random.default_rng(4), []
    for _ in range(80):
        true_velocity = rng.multivariate_normal(np.zeros(8), vertex_track.started(QUAD, 3.0, 0.0026).covariance[8:, 8:])
        track = vertex_track.started(QUAD + rng.normal(0, 3.0, (4, 2)), 3.0, 0.0026)
        for step in range(4):
            true = QUAD + step * true_velocity.reshape(4, 2)
            for edge, pair in enumerate(EDGES):
                normal = edge_normals(true[list(pair)], true.mean(axis=0))
                shifted = true[list(pair)] + rng.normal(0, 0.4, (2, 1)) * normal
                track = vertex_track.updated(track, edge, shifted, normal, 0.4**2 * np.eye(2))
            track = vertex_track.predicted(track, 1.0, 1e-12, 0.0)
        error = np.ravel(QUAD + 4 * true_velocity.reshape(4, 2) - track.vertices_px)
        squares.append(error @ np.linalg.solve(track.covariance[:8, :8], error))
    assert np.mean(squares) == pytest.approx(8, abs=4 * np.sqrt(16 / 80) + 0.5)


def test_lines_meet_at_the_vertices():
    assert intersections(edge_ends(QUAD)) == pytest.approx(QUAD, abs=1e-9)
    stretched = edge_ends(QUAD)
    stretched[:, 1] += 0.7 * (stretched[:, 1] - stretched[:, 0])
    assert intersections(stretched) == pytest.approx(QUAD, abs=1e-9)
    normals = edge_normals(edge_ends(QUAD), QUAD.mean(axis=0))
    assert np.linalg.norm(normals, axis=-1) == pytest.approx(1)
    assert normals[0] @ [0, 1] > 0.9  # P1P2 is the lower edge: outward is down, +y
    assert normals[2] @ [-1, 0] > 0.9


def test_a_robust_line_ignores_a_third_and_tells_its_scatter():
    rng = np.random.default_rng(5)
    fraction = np.linspace(0.05, 0.95, 90)
    distance = 0.3 - 0.5 * fraction + rng.normal(0, 0.03, 90)
    distance[30:55] = 1.6
    line = robust_line(fraction, distance, np.ones(90))
    assert line.shift_px == pytest.approx([0.3, -0.2], abs=0.03)
    assert line.scale_px == pytest.approx(0.03, rel=0.6)
    assert line.inliers.sum() == 65
    spread = [robust_line(fraction, rng.normal(0, 0.03, 90), np.ones(90)) for _ in range(400)]
    assert np.std([s.shift_px for s in spread], axis=0) == pytest.approx(
        np.sqrt(np.mean([np.diag(s.covariance) for s in spread], axis=0)), rel=0.12
    )
    assert robust_line(fraction[:3], distance[:3], np.ones(3)) is None
    assert robust_line(np.full(20, 0.5), np.zeros(20), np.ones(20)) is None


def test_a_rigid_rectangle_keeps_its_sides():
    memory = AspectMemory(0.5, 4.0)
    assert memory.squared_sigmas(3.0, 0.1) == 0
    for value in (1.00, 1.01, 0.99, 1.0):
        assert memory.why_not(_with_aspect(value)) == ""
    assert "an edge is another's" in memory.why_not(_with_aspect(1.3))
    assert memory.why_not(_with_aspect(1.005)) == ""
    memory.forget()
    assert memory.why_not(_with_aspect(1.3)) == ""


def _with_aspect(aspect):
    return Solution(Rotation.identity(), np.eye(3), QUAD, np.log(aspect), 0.003, 0.0, 0.01)
