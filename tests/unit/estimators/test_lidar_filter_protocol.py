"""What both LIDAR filters promise to their users: instants, signs, refusals, named numbers, and sentences when they diverge."""

from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.lidar_filter.chaser import at_rest, chaser_at
from estimators.lidar_filter.measurement import Innovation, PoseFilter, PoseMeasurement
from estimators.lidar_filter.paper_filter import PaperFilter
from estimators.lidar_filter.paper_filter_parameters import GuessParameters, PaperFilterParameters, Repairs
from estimators.lidar_filter.tumble_filter import TumbleFilter, fault, stated
from estimators.lidar_filter.tumble_filter_parameters import MeasurementParameters, StartParameters, TumbleParameters
from estimators.lidar_filter.tumble_filter_state import bounded
from scenes.inertia import components_of, inertia_of
from scenes.recording import ChaserState

MOUNT = RigidTransform.from_components([0.1, -0.2, 2.0], Rotation.from_rotvec([0.1, -0.2, 0.3]))
OMEGA = np.array([0.02, -0.03, 0.01])
OFFSET = np.array([0.3, -0.2, 0.5])
COVARIANCE = np.diag(np.repeat([0.005, 0.05], 3)) ** 2
FIRST = Rotation.from_rotvec([0.4, 1.2, -0.7])
BOTH = pytest.mark.parametrize("kind", [TumbleFilter, PaperFilter])


def orbiting(time_s, sign=1.0):
    """A chaser on a circular orbit that turns slowly; ``sign`` of the quaternion that says how it is turned."""
    n, radius = 1.08e-3, 7e6
    c, s = np.cos(n * time_s), np.sin(n * time_s)
    turn = Rotation.from_rotvec([2.9, 0.1, 0.2]) * Rotation.from_rotvec(np.array([0, 1e-3, 0]) * time_s)
    place, speed = radius * np.array([c, s, 0]), n * radius * np.array([-s, c, 0])
    return ChaserState(time_s, Rotation.from_quat(sign * turn.as_quat()), place, speed, np.array([0, 1e-3, 0]))


def pose(time_s, chaser, sign=1.0):
    """lidar_from_target of a sphere that turns steadily, its centre 40 m before the chaser and 0.02 m/s away from it."""
    inertial = FIRST * Rotation.from_rotvec(OMEGA * time_s)
    centre = MOUNT.inv().apply(chaser.inertial_from_chaser.inv().apply([1.0, 2.0, 40 + 0.02 * time_s]))
    rotation = MOUNT.rotation.inv() * chaser.inertial_from_chaser.inv() * inertial
    return RigidTransform.from_components(
        centre + rotation.apply(OFFSET), Rotation.from_quat(sign * rotation.as_quat(canonical=True))
    )


def measurement(time_s, chaser, sign=1.0):
    return PoseMeasurement(time_s, pose(time_s, chaser, sign), COVARIANCE)


def made(kind, **more):
    parameters = {TumbleFilter: TumbleParameters, PaperFilter: PaperFilterParameters}[kind]
    return kind(MOUNT, parameters(**more))


def followed(kind, seconds, chaser_of=at_rest, sign=lambda k: 1.0, **more):
    found = made(kind, **more)
    found.start(measurement(0.0, chaser_of(0.0), sign(0)), chaser_of(0.0))
    for k in range(1, seconds + 1):
        found.update(measurement(float(k), chaser_of(float(k)), sign(k)), chaser_of(float(k)))
    return found


def same(one, other, within=1e-9):
    a, b = one.extras(), other.extras()
    assert a.keys() == b.keys()
    assert max(abs(a[name] - b[name]) for name in a) < within


def off(found, chaser):
    """Radians and metres between the filter's pose and the truth at the chaser's time."""
    error = found.lidar_from_target(chaser).inv() * pose(chaser.time_s, chaser)
    return error.rotation.magnitude(), np.linalg.norm(error.translation)


@BOTH
def test_a_steady_rotation_is_learnt_and_predicted(kind):
    found = followed(kind, 120)
    extras = found.extras()
    assert found.is_sound() == ""
    assert [extras[f"omega_{axis}_rad_s"] for axis in "xyz"] == pytest.approx(OMEGA, abs=3e-4)
    turn, place = off(found, at_rest(125.0))
    assert turn < 5e-3
    assert place < 0.1
    assert off(made_then_still(kind), at_rest(125.0))[0] > 1  # a control: without the rotation it would be elsewhere


def made_then_still(kind):
    found = made(kind)
    found.start(measurement(0.0, at_rest(0.0)), at_rest(0.0))
    return found


@BOTH
def test_asking_for_a_pose_changes_nothing(kind):
    one, other = followed(kind, 20), followed(kind, 20)
    one.lidar_from_target(at_rest(27.0))
    same(one, other, within=1e-15)


@BOTH
def test_a_filter_is_a_pose_filter(kind):
    found: PoseFilter = made(kind)
    assert found.extras() == {}
    assert found.is_sound() == ""
    with pytest.raises(RuntimeError, match="not been started"):
        found.predict(at_rest(0.0))
    with pytest.raises(RuntimeError, match="not been started"):
        found.update(measurement(0.0, at_rest(0.0)), at_rest(0.0))
    assert Innovation(4.0, 6, True).extras() == {"nis": 4.0, "nis_dof": 6.0, "accepted": 1.0}


@pytest.mark.parametrize(("kind", "more"), [(TumbleFilter, {}), (PaperFilter, {"at_own_instant": True})])
@pytest.mark.parametrize("chaser_of", [at_rest, orbiting])
def test_a_late_scan_is_taken_in_at_its_own_instant(kind, more, chaser_of):
    """The same measurements, said to be 0.4 s old or told at once: the same filter at every instant, also if asked beyond."""
    prompt, late = made(kind, **more), made(kind, **more)
    there, now = (chaser_of(time_s) for time_s in (0.0, 0.4))
    prompt.start(measurement(0.0, there), there)
    late.start(measurement(0.0, there), now)
    for k in range(1, 41):
        there, now = (chaser_of(time_s) for time_s in (float(k), k + 0.4))
        told, heard = prompt.update(measurement(k, there), there), late.update(measurement(k, there), now)
        assert heard.nis == pytest.approx(told.nis, rel=1e-6, abs=1e-12)
    a, b = prompt.lidar_from_target(now), late.lidar_from_target(now)
    assert (a.inv() * b).rotation.magnitude() < 1e-12
    assert np.linalg.norm((a.inv() * b).translation) < 1e-8
    prompt.predict(now)
    same(prompt, late, within=1e-8)


def test_a_delay_that_is_not_told_shows():
    found = made(TumbleFilter)
    for k in range(41):
        there, now = at_rest(float(k)), at_rest(k + 0.4)
        stale = replace(measurement(k, there), time_s=now.time_s)
        found.update(stale, now) if k else found.start(stale, now)
    turn, _ = off(found, at_rest(40.4))
    assert turn == pytest.approx(0.4 * np.linalg.norm(OMEGA), rel=0.1)


@BOTH
def test_a_scan_older_than_the_last_is_refused(kind):
    found = followed(kind, 10, **({"at_own_instant": True} if kind is PaperFilter else {}))
    turn, place = off(found, at_rest(10.0))
    assert not found.update(measurement(8.0, at_rest(8.0)), at_rest(10.0)).accepted
    assert off(found, at_rest(10.0)) == (pytest.approx(turn), pytest.approx(place))


@BOTH
@pytest.mark.parametrize("sign", [lambda k: -1.0, lambda k: (-1.0) ** k])
def test_the_sign_of_a_quaternion_says_nothing(kind, sign):
    plain = followed(kind, 150, orbiting)
    same(plain, followed(kind, 150, orbiting, sign=sign))
    flipped = followed(kind, 150, lambda time_s: orbiting(time_s, sign(int(time_s))))
    same(plain, flipped)


def test_without_its_alignment_the_papers_filter_follows_the_sign():
    """150 s at 0.037 rad/s are most of a turn: the canonical sign of the measured quaternion jumps on the way."""
    plain = followed(PaperFilter, 150, orbiting)
    unlike = followed(PaperFilter, 150, orbiting, repairs=Repairs(sign_alignment=False))
    assert off(plain, orbiting(150.0))[0] < 0.05
    assert off(unlike, orbiting(150.0))[0] > 0.2


@BOTH
def test_named_numbers_are_the_judges(kind):
    extras = followed(kind, 5).extras()
    vectors = (("omega_", "_rad_s"), ("rel_", "_m"), ("rel_v", "_m_s"), ("com_", "_m"))
    axes = [f"{head}{axis}{unit}" for head, unit in vectors for axis in "xyz"]
    inertia = [f"inertia_{i}" for i in range(1, 6)]
    sigmas = [f"sigma_{name}" for name in [*(f"attitude_{axis}_rad" for axis in "xyz"), *axes, *inertia]]
    covariance = [f"cov_{i}_{j}" for i in range(20) for j in range(i, 20)]
    derived = ["p1", "p2", "body_qw", "body_qx", "body_qy", "body_qz", "infeasible_inertia"]
    assert sorted(extras) == sorted([*axes, *inertia, *sigmas, *covariance, *derived])
    assert len(covariance) == 210
    assert all(type(value) is float and np.isfinite(value) for value in extras.values())
    assert extras["sigma_omega_y_rad_s"] == pytest.approx(extras["cov_4_4"] ** 0.5)
    assert extras["sigma_com_z_m"] == pytest.approx(extras["cov_19_19"] ** 0.5)
    assert sum(extras[f"body_q{axis}"] ** 2 for axis in "wxyz") == pytest.approx(1)


def test_derived_axes_give_the_inertia_back():
    extras = followed(TumbleFilter, 30).extras()
    axes = Rotation.from_quat([extras[f"body_q{axis}"] for axis in "xyzw"]).as_matrix()
    J = axes @ np.diag([1.0, extras["p1"], extras["p2"]]) @ axes.T
    assert components_of(J) == pytest.approx([extras[f"inertia_{i}"] for i in range(1, 6)], abs=1e-9)
    assert 1 <= extras["p1"] <= extras["p2"]


def test_the_papers_axes_are_its_own_and_give_the_inertia_back():
    guess = GuessParameters(p=(2.0, 1.5), body_from_target_wxyz=(0.5, -0.5, 0.5, 0.5))
    found = made(PaperFilter, guess=guess)
    found.start(measurement(0.0, at_rest(0.0)), at_rest(0.0))
    extras = found.extras()
    assert (extras["p1"], extras["p2"]) == (pytest.approx(2.0), pytest.approx(1.5))
    axes = Rotation.from_quat([extras[f"body_q{axis}"] for axis in "xyzw"]).as_matrix()
    J = axes @ np.diag([1.0, 2.0, 1.5]) @ axes.T
    assert components_of(J) == pytest.approx([extras[f"inertia_{i}"] for i in range(1, 6)], abs=1e-12)


def test_an_inertia_that_no_body_has_is_reported():
    infeasible = GuessParameters(p=(3.0, 4.5))  # 150 % of the paper's, which is a lamina's
    found = made(PaperFilter, guess=infeasible)
    found.start(measurement(0.0, at_rest(0.0)), at_rest(0.0))
    assert found.extras()["infeasible_inertia"] == 1.0
    assert "1, 3, 4.5" in found.guess_fault()
    lamina = made(PaperFilter, guess=GuessParameters(p=(2.0, 3.0)))
    assert lamina.guess_fault() == ""
    with pytest.raises(ValidationError):
        GuessParameters(p=(-1.0, 2.0))


def test_an_inertia_with_a_negative_moment_is_brought_back():
    axes = Rotation.from_rotvec([0.3, -0.4, 1.0]).as_matrix()
    wrong = components_of(axes @ np.diag([-0.2, 1.2, 2.0]) @ axes.T)
    moments, found = np.linalg.eigh(inertia_of(bounded(wrong, 0.05)))
    assert moments == pytest.approx(np.array([0.05, 1.2, 2.0]) * 3 / 3.25)
    assert np.abs(np.abs(found.T @ axes) - np.eye(3)).max() < 1e-12
    fine = components_of(np.diag([0.5, 1.0, 1.5]))
    assert (bounded(fine, 0.05) == fine).all()


def jumped(time_s, chaser, metres):
    exact = measurement(time_s, chaser)
    moved = RigidTransform.from_components(exact.lidar_from_target.translation + metres, exact.lidar_from_target.rotation)
    return replace(exact, lidar_from_target=moved)


def test_the_gate_refuses_what_no_motion_explains():
    found = followed(TumbleFilter, 60)
    before = off(found, at_rest(61.0))
    innovation = found.update(jumped(61.0, at_rest(61.0), 3.0), at_rest(61.0))
    assert not innovation.accepted
    assert innovation.nis > 100
    assert off(found, at_rest(61.0)) == pytest.approx(before, abs=1e-6)
    open_to_all = followed(TumbleFilter, 60, measurement=MeasurementParameters(gate=1.0))
    assert open_to_all.update(jumped(61.0, at_rest(61.0), 3.0), at_rest(61.0)).accepted
    assert off(open_to_all, at_rest(61.0))[1] > 5 * before[1]


def test_after_several_refusals_it_is_the_filter_that_is_doubted():
    """The target has moved by 3 m at once: five scans are refused, the sixth is believed, and rates are learnt anew."""
    found = followed(TumbleFilter, 60)
    learnt = found.extras()["sigma_inertia_1"]
    verdicts = [found.update(jumped(float(k), at_rest(float(k)), 3.0), at_rest(float(k))).accepted for k in range(61, 80)]
    assert verdicts == [False] * 5 + [True] * 14
    error = found.lidar_from_target(at_rest(80.0)).inv() * jumped(80.0, at_rest(80.0), 3.0).lidar_from_target
    assert error.rotation.magnitude() < 0.01
    assert np.linalg.norm(error.translation) < 0.2
    assert found.extras()["sigma_inertia_1"] < 3 * learnt  # what does not change is remembered


def test_numbers_that_are_none_are_refused_and_leave_the_filter_alone():
    found = followed(TumbleFilter, 20)
    bad = replace(measurement(21.0, at_rest(21.0)), covariance=np.full((6, 6), np.nan))
    assert not found.update(bad, at_rest(21.0)).accepted
    assert found.is_sound() == ""
    assert off(found, at_rest(21.0))[0] < 0.01


def test_unsound_states_are_named():
    state = followed(TumbleFilter, 3).state
    assert fault(state) == ""
    assert "not a number" in fault(replace(state, omega_rad_s=np.full(3, np.nan)))
    assert "not positive" in fault(replace(state, covariance=-state.covariance))
    broken = made(PaperFilter, printed=True, guess=GuessParameters(omega_body_rad_s=(1e5, -1e5, 1e5), p=(0.01, 5.0)))
    broken.start(measurement(0.0, at_rest(0.0)), at_rest(0.0))
    for k in range(1, 40):
        broken.update(measurement(float(k), at_rest(float(k))), at_rest(float(k)))
    assert broken.is_sound()
    assert np.isfinite(broken.lidar_from_target(at_rest(41.0)).as_matrix()).all()


def test_without_an_orbit_the_target_flies_straight():
    found = followed(TumbleFilter, 200)
    extras = found.extras()
    assert [extras[f"rel_v{axis}_m_s"] for axis in "xyz"] == pytest.approx([0, 0, 0.02], abs=2e-3)
    found.predict(at_rest(230.0))
    assert found.extras()["rel_z_m"] - extras["rel_z_m"] == pytest.approx(0.6, abs=0.06)
    assert found.extras()["sigma_rel_z_m"] > extras["sigma_rel_z_m"]


def test_uncertainty_grows_while_nothing_is_seen():
    found = followed(TumbleFilter, 60)
    sigmas = []
    for k in range(61, 91):
        found.predict(at_rest(float(k)))
        sigmas.append(found.extras()["sigma_attitude_x_rad"])
    assert (np.diff(sigmas) > 0).all()
    assert found.update(measurement(91.0, at_rest(91.0)), at_rest(91.0)).accepted


def test_the_chaser_at_rest_stays():
    assert chaser_at(at_rest(3.0), 8.0).time_s == 8.0
    assert chaser_at(at_rest(3.0), 8.0).inertial_from_chaser.magnitude() == 0


def test_the_start_knows_the_distance_and_nothing_else():
    found = made(TumbleFilter, start=StartParameters(omega_rad_s=0.2, inertia=0.3, velocity_m_s=0.5, offset_m=1.5))
    found.start(measurement(0.0, at_rest(0.0)), at_rest(0.0))
    extras = found.extras()
    assert [extras[f"sigma_{name}"] for name in ("omega_x_rad_s", "inertia_3", "rel_vy_m_s", "com_z_m")] == pytest.approx(
        [0.2, 0.3, 0.5, 1.5], rel=1e-3
    )
    assert extras["sigma_attitude_x_rad"] == pytest.approx(0.005, rel=1e-3)
    assert extras["sigma_rel_x_m"] == pytest.approx(np.hypot(1.5, 0.05), rel=1e-2)  # as far as the centre of mass may be off
    assert [extras[f"rel_{axis}_m"] for axis in "xyz"] == pytest.approx([1, 2, 40], abs=np.linalg.norm(OFFSET))


def test_a_share_of_the_stated_covariance_lasts():
    stating = np.diag(np.arange(1.0, 7.0))
    measurement = MeasurementParameters(scale=2.0, lasting=0.25, floor_rad=0.1, floor_m=0.2, drift_rad=0.3, drift_m=0.4)
    fresh, lasting = stated(stating, TumbleParameters(measurement=measurement))
    assert fresh == pytest.approx(1.5 * stating + np.diag([0.01] * 3 + [0.04] * 3))
    assert lasting == pytest.approx(0.5 * stating + np.diag([0.09] * 3 + [0.16] * 3))


def test_what_lasts_does_not_average_out():
    """A hundred measurements whose errors last say less than as many whose errors do not."""
    sigmas = [
        followed(TumbleFilter, 100, measurement=MeasurementParameters(lasting=lasting, drift_time_s=30.0)).extras()
        for lasting in (0.9, 0.0)
    ]
    for name in ("sigma_attitude_x_rad", "sigma_attitude_y_rad"):
        assert sigmas[0][name] > 1.3 * sigmas[1][name]
    found = made(TumbleFilter, measurement=MeasurementParameters(lasting=0.9))
    found.start(measurement(0.0, at_rest(0.0)), at_rest(0.0))
    assert found.state.drift_spread == pytest.approx(0.9 * COVARIANCE)
