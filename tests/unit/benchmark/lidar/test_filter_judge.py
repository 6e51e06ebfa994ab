"""Filters against the truth: exact answers are exact in any frame, labels never matter, σ is honest or found out."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation
from scipy.stats import chi2

from benchmark.errors import PredictionsError
from benchmark.filter_nees import mean_bounds
from benchmark.filter_states import STATES, VECTOR
from benchmark.filter_summary import FilterSummary
from benchmark.judge import Judgement, judge
from benchmark.leaderboard import cells
from benchmark.predictions import Predictions
from scenes.dataset import Dataset
from scenes.inertia import inertia_of, principal_axes, relabellings

OWN = RigidTransform.from_components([0.7, -0.4, 1.1], Rotation.from_euler("xyz", [25.0, 60.0, -110.0], degrees=True))


def _block(judgement: Judgement) -> FilterSummary:
    (summary,) = judgement.summaries
    assert summary.filter is not None
    return summary.filter


@pytest.mark.parametrize("own", [None, OWN])
def test_the_truth_as_answer_is_exact_whatever_frame_it_is_told_in(lidar_dataset: Dataset, fabricate: Any, own: Any) -> None:
    judgement = judge(fabricate(lidar_dataset).answers(own), lidar_dataset)
    (summary,), scores = judgement.summaries, judgement.scores
    assert (summary.answered, summary.wrong) == (40, 0)
    assert scores["geodesic_deg"].max() < 1e-5
    assert scores["position_error_m"].max() < 1e-9
    for name in VECTOR:
        assert scores[name].abs().max() < 1e-9, name
    for name in ("inertia_error", "p1_error", "p2_error", "q_pb_error_rad"):
        assert scores[name].abs().max() < 1e-7, name
    block = _block(judgement)
    assert block.gauge == ("target" if own is None else "own, aligned on frame 0")
    assert set(block.states) == {state.key for state in STATES}
    assert all(one.settled_s == 0.0 and one.is_met for one in block.states.values())
    assert block.is_converged
    assert block.nees is None  # no covariance was stated


def test_in_another_frame_than_the_models_the_same_answers_are_wrong(lidar_dataset: Dataset, fabricate: Any) -> None:
    """The control: with a model told, nothing is aligned."""
    answers = fabricate(lidar_dataset).answers(OWN)
    told = fabricate(lidar_dataset).answers().record
    judgement = judge(Predictions(told, answers.table, answers.extras), lidar_dataset)
    assert judgement.summaries[0].wrong == 40
    assert judgement.scores["position_error_m"].min() > 1.0
    assert not _block(judgement).is_converged


def test_alignment_is_made_once_and_does_not_hide_what_moves_afterwards(lidar_dataset: Dataset, fabricate: Any) -> None:
    """A frame of the method's own that turns by 0.1 degrees a second about its x axis on the target."""
    errors = np.zeros((40, 20))
    errors[:, 0] = np.radians(0.1) * np.arange(40)
    judgement = judge(fabricate(lidar_dataset).answers(OWN, errors=errors), lidar_dataset)
    np.testing.assert_allclose(judgement.scores["geodesic_deg"], 0.1 * np.arange(40), atol=1e-6)
    drift = _block(judgement).drift
    assert drift is not None
    assert drift.attitude_deg_per_100s == pytest.approx(10.0, rel=1e-6)
    assert drift.attitude_final_deg == pytest.approx(3.85, abs=1e-6)  # the median of the last two frames
    told = judge(fabricate(lidar_dataset).answers(errors=errors), lidar_dataset)
    assert _block(told).drift is None


def test_the_first_answered_frame_is_the_one_that_is_aligned(lidar_dataset: Dataset, fabricate: Any) -> None:
    judgement = judge(fabricate(lidar_dataset).answers(OWN, missing=(0, 1, 2)), lidar_dataset)
    assert _block(judgement).gauge == "own, aligned on frame 3"
    assert judgement.scores["geodesic_deg"].max() < 1e-5
    assert judgement.summaries[0].answered == 37
    none = judge(fabricate(lidar_dataset).answers(OWN, missing=tuple(range(40))), lidar_dataset)
    assert (_block(none).gauge, _block(none).states, none.summaries[0].answered) == ("own", {}, 0)


@pytest.mark.parametrize("own", [None, OWN])
def test_errors_of_the_stated_covariance_have_a_nees_of_twenty(make_lidar: Any, tmp_path: Any, fabricate: Any, own: Any) -> None:
    """400 independent draws: the mean of χ²₂₀ lies within ±3 % of 20; half the covariance gives 40, far outside."""
    dataset, random = make_lidar(tmp_path / "long", frames=range(400)), np.random.default_rng(3)
    maker = fabricate(dataset)
    stated = np.stack([maker.covariance(random) for _ in range(400)])
    errors = np.stack([random.multivariate_normal(np.zeros(20), one) for one in stated])
    if own is not None:
        errors[0, :3] = 0.0  # the frame on which it is aligned has no attitude error by construction
    low, high = mean_bounds(20, 399)
    assert (low, high) == pytest.approx((19.38, 20.63), abs=0.02)
    honest = judge(maker.answers(own, errors, stated), dataset).scores["nees"].to_numpy()[1:]
    assert low < honest.mean() < high
    assert 0.02 < np.mean((honest < chi2.ppf(0.025, 20)) | (honest > chi2.ppf(0.975, 20))) < 0.09
    proud = judge(maker.answers(own, errors, stated / 2), dataset).scores["nees"].to_numpy()[1:]
    np.testing.assert_allclose(proud, 2 * honest, rtol=1e-6)
    assert proud.mean() > high


def test_nees_does_not_forgive_a_wrong_sign_between_two_states(make_lidar: Any, tmp_path: Any, fabricate: Any) -> None:
    """ρ is minus the centre of mass: with the sign of its covariances turned, errors that hang together look improbable."""
    dataset, maker_random = make_lidar(tmp_path / "signs", frames=range(200)), np.random.default_rng(4)
    maker, correlation = fabricate(dataset), np.eye(20)
    correlation[11:14, 17:20] = correlation[17:20, 11:14] = 0.95 * np.eye(3)  # r and ρ move together
    sigmas = np.repeat([0.01, 1e-4, 0.02, 0.05, 0.002, 0.03], (3, 3, 5, 3, 3, 3))
    stated = np.broadcast_to(correlation * np.outer(sigmas, sigmas), (200, 20, 20))
    errors = maker_random.multivariate_normal(np.zeros(20), stated[0], size=200)
    right = judge(maker.answers(None, errors, stated), dataset).scores["nees"].mean()
    flipped = errors * np.where(np.arange(20) >= 17, -1.0, 1.0)
    wrong = judge(maker.answers(None, flipped, stated), dataset).scores["nees"].mean()
    assert right == pytest.approx(20, rel=0.1)
    assert wrong > 100


def test_no_labelling_of_the_principal_axes_changes_a_score(lidar_dataset: Dataset, fabricate: Any) -> None:
    """24 labellings of the true axes, told as p1, p2 and target_from_body with the components left out, as labels."""
    maker = fabricate(lidar_dataset)
    _, named = maker.states(0.0, OWN, np.zeros(20))
    moments, own_from_body = principal_axes(inertia_of([named[f"inertia_{i}"] for i in range(1, 6)]))
    for matrix in relabellings():
        labelled = own_from_body * Rotation.from_matrix(matrix.T)
        x, y, z = np.abs(matrix) @ moments
        quaternion = labelled.as_quat(scalar_first=True)
        ratios = {"p1": y / x, "p2": z / x, **{f"body_q{axis}": q for axis, q in zip("wxyz", quaternion)}}
        answers = maker.answers(OWN, more=lambda _, ratios=ratios: ratios)
        extras = answers.extras.drop(columns=[f"inertia_{i}" for i in range(1, 6)])
        scores = judge(Predictions(answers.record, answers.table, extras), lidar_dataset).scores
        for name in ("p1_error", "p2_error", "q_pb_error_rad", "inertia_error"):
            assert scores[name].abs().max() < 1e-7


def test_what_a_method_calls_its_ratios_is_not_read_where_it_gives_the_inertia(lidar_dataset: Dataset, fabricate: Any) -> None:
    answers = fabricate(lidar_dataset).answers(more=lambda _: {"p1": 17.0, "p2": -3.0, "body_qw": 1.0})
    assert judge(answers, lidar_dataset).scores["p1_error"].abs().max() < 1e-7


def test_an_infeasible_inertia_and_predictions_are_counted(lidar_dataset: Dataset, fabricate: Any) -> None:
    def more(frame: int) -> dict[str, float]:
        gated = {"nis": 6.0, "nis_dof": 6.0, "accepted": float(frame % 4 != 0)} if frame % 5 else {}
        return {"infeasible_inertia": float(frame < 7), "predicted": float(frame % 5 == 0), "cpu_icp_s": 0.02, **gated}

    block = _block(judge(fabricate(lidar_dataset).answers(more=more, missing=(39,)), lidar_dataset))
    assert (block.infeasible, block.predicted) == (7, 8)
    assert block.accepted_fraction == pytest.approx(23 / 31)  # 31 scans were used, 8 of them refused
    assert block.nis is not None
    assert (block.nis.mean, block.nis.expected, block.nis.frames) == (6.0, 6.0, 4)  # 33, 34, 37, 38 of the last fifth
    assert block.stage_cpu_s == {"icp": pytest.approx(0.02)}
    assert (block.steady_frames, block.steady_answered) == (8, 7)
    assert not block.is_converged


def test_registration_is_judged_at_the_scans_own_instant_in_the_truths_frame(
    lidar_dataset: Dataset, fabricate: Any, icp_of: Callable[..., Any]
) -> None:
    """Off by 1 degree about an axis through the target's origin and by 2 cm."""
    off = RigidTransform.from_components([0.0, 0.02, 0.0], Rotation.from_euler("y", 1.0, degrees=True))
    block = _block(judge(fabricate(lidar_dataset).answers(OWN, more=icp_of(off, OWN)), lidar_dataset))
    assert block.icp_attitude_median_deg == pytest.approx(1.0, abs=1e-6)
    assert block.icp_position_p95_m == pytest.approx(0.02, abs=1e-9)


def test_symmetric_targets_may_be_answered_in_any_attitude_that_looks_alike(
    make_lidar: Any, tmp_path: Any, fabricate: Any, lidar_target: Any
) -> None:
    """The states are then those of the turned frame: ω, the inertia and ρ as seen in it."""
    dataset = make_lidar(tmp_path / "alike", frames=range(10), target={**lidar_target, "symmetry": "c2-y"})
    half_turn = RigidTransform.from_rotation(Rotation.from_euler("y", 180.0, degrees=True))
    told = fabricate(dataset).answers().record
    turned = fabricate(dataset).answers(half_turn)
    judgement = judge(Predictions(told, turned.table, turned.extras), dataset)
    assert judgement.summaries[0].wrong == 0
    assert judgement.scores[list(VECTOR)].abs().max().max() < 1e-9
    assert _block(judgement).gauge == "target, in an attitude that looks alike (c2-y)"


def test_without_mass_what_is_unknown_is_left_out(make_lidar: Any, tmp_path: Any, fabricate: Any, lidar_target: Any) -> None:
    exact = fabricate(make_lidar(tmp_path / "mass", frames=range(5)))
    answers = exact.answers()
    dataset = make_lidar(tmp_path / "none", frames=range(5), target={**lidar_target, "mass": None})
    record = answers.record.model_copy(update={"dataset_identity": dataset.identity})
    block = _block(judge(Predictions(record, answers.table, answers.extras), dataset))
    assert set(block.states) == {"attitude", "r", "v"}
    assert (block.inertia_error, block.is_converged) == (None, True)


def test_a_method_without_extras_is_judged_by_its_poses(lidar_dataset: Dataset, fabricate: Any) -> None:
    answers = fabricate(lidar_dataset).answers()
    block = _block(judge(Predictions(answers.record, answers.table), lidar_dataset))
    assert set(block.states) == {"attitude"}


def test_answers_for_a_sensor_that_is_not_there_are_refused(lidar_dataset: Dataset, fabricate: Any) -> None:
    with pytest.raises(PredictionsError, match=r"no sensor is called 'ladar'; did you mean 'lidar'\?"):
        judge(fabricate(lidar_dataset).answers(sensor="ladar"), lidar_dataset)


def test_numbers_that_are_not_finite_do_not_break_the_summary(lidar_dataset: Dataset, fabricate: Any) -> None:
    def more(frame: int) -> dict[str, float]:
        return {"rel_x_m": np.inf if frame == 35 else 30.0, "inertia_1": np.nan if frame == 36 else 0.0, "nis": np.nan}

    block = _block(judge(fabricate(lidar_dataset).answers(more=more), lidar_dataset))
    assert block.states["r"].worst is not None
    assert block.states["r"].worst > 1e11
    assert not block.states["r"].is_met
    assert block.states["p"].worst is not None
    assert block.nis is None


def test_a_filter_that_runs_off_to_huge_numbers_is_judged_all_the_same(lidar_dataset: Dataset, fabricate: Any) -> None:
    """Just before it gives up a diverging filter states what it likes; squares of it overflow."""
    errors = np.zeros((40, 20))
    errors[30:, 11:] = np.geomspace(1e3, 1e200, 10)[:, None]
    stated = np.broadcast_to(np.eye(20) * 1e-4, (40, 20, 20))
    answers = fabricate(lidar_dataset).answers(errors=errors, covariances=stated)
    answers.table.loc[35:, ["tx_m", "ty_m", "tz_m"]] = 1e180
    (summary,) = judge(answers, lidar_dataset).summaries
    assert summary.filter is not None
    worst = summary.filter.states["r"].worst
    assert worst is not None
    assert worst > 1e11
    assert cells(summary)["r m"] == f"{worst:.1e}"
    assert summary.filter.nees is not None
    assert not summary.filter.nees.is_honest
    assert type(summary).model_validate_json(summary.model_dump_json()) == summary
