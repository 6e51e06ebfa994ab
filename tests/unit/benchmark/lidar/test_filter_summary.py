"""Figures of the filter block by hand, and of all seeds together."""

from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from benchmark.filter_cells import heading, of_line, of_summary
from benchmark.filter_nees import mean_bounds
from benchmark.filter_seeds import seeds_lines
from benchmark.filter_states import STATES
from benchmark.filter_summary import settled_time, three_sigma
from benchmark.judge import judge
from benchmark.leaderboard import Row, cells
from benchmark.results import Entry
from benchmark.summary import Summary
from scenes.dataset import Dataset

TIME_S = np.arange(6.0) * 2


@pytest.mark.parametrize(
    ("within", "settled_s"),
    [
        ([1, 1, 1, 1, 1, 1], 0.0),
        ([0, 1, 0, 1, 1, 1], 6.0),
        ([0, 0, 0, 0, 0, 1], 10.0),
        ([1, 1, 1, 1, 1, 0], None),
        ([0, 0, 0, 0, 0, 0], None),
    ],
)
def test_the_time_of_convergence_is_the_first_after_which_nothing_leaves(within: list[int], settled_s: float | None) -> None:
    assert settled_time(np.array(within, dtype=bool), TIME_S) == settled_s


def test_three_sigma_is_about_zero_not_about_the_mean() -> None:
    """A constant error of 0.1 is no scatter, and still an error of 0.3 at 3σ."""
    errors = np.stack([np.full(50, 0.1), np.tile([0.2, -0.2], 25), np.zeros(50)], axis=1)
    np.testing.assert_allclose(three_sigma(errors), [0.3, 0.6, 0.0])


def test_bounds_of_a_mean_by_hand() -> None:
    assert mean_bounds(20) == pytest.approx((9.591, 34.170), abs=1e-3)  # tables of χ²
    assert mean_bounds(20, 20) == pytest.approx((17.3, 22.9), abs=0.1)
    assert mean_bounds(6, 500)[1] == pytest.approx(chi2.ppf(0.975, 3000) / 500)


def _row(summary: Summary, case: str) -> Row:
    entry = Entry(case=case, feature=None, title=summary.title, dataset="d", answers="a", scores="s")
    return Row(entry, summary, cells(summary))


def _errors(frames: int, **state_errors: Any) -> np.ndarray:
    """(frames, 20) with a slice set: theta=(first value ...)."""
    places = {"theta": 0, "omega": 3, "r": 11, "v": 14, "rho": 17}
    errors = np.zeros((frames, 20))
    for name, values in state_errors.items():
        errors[:, places[name]] = values
    return errors


def test_a_block_by_hand(lidar_dataset: Dataset, fabricate: Any) -> None:
    """40 s: r is 1 m off until 20 s, then ±0.2; v is 6 mm/s off at 30 s only; ω grows and leaves the level at the end."""
    time_s = np.arange(40.0)
    r = np.where(time_s < 20, 1.0, np.where(time_s % 2, 0.2, -0.2))
    errors = _errors(40, r=r, v=np.where(time_s == 30, 0.006, 0.0), omega=np.where(time_s == 39, 0.011, 0.001))
    (summary,) = judge(fabricate(lidar_dataset).answers(errors=errors), lidar_dataset).summaries
    assert summary.filter is not None
    states = summary.filter.states
    assert summary.filter.steady_from_s == pytest.approx(31.2)
    assert states["r"].three_sigma == pytest.approx((0.6, 0.0, 0.0), abs=1e-9)
    assert (states["r"].worst, states["r"].settled_s) == (pytest.approx(0.6), 20.0)
    assert not states["r"].is_met  # 0.6 m against 0.3 m
    assert states["v"].settled_s == 31.0
    assert states["omega"].settled_s is None
    assert states["omega"].three_sigma[0] == pytest.approx(3 * np.sqrt((7 * 0.001**2 + 0.011**2) / 8))
    assert of_summary(summary, summary.filter)["r m"] == "0.600"
    assert cells(summary) == of_summary(summary, summary.filter)


def test_an_unanswered_frame_is_outside_every_level(lidar_dataset: Dataset, fabricate: Any) -> None:
    (summary,) = judge(fabricate(lidar_dataset).answers(missing=(10, 25)), lidar_dataset).summaries
    assert summary.filter is not None
    assert {one.settled_s for one in summary.filter.states.values()} == {26.0}
    assert summary.filter.is_converged


def test_old_summaries_without_a_filter_block_are_read(lidar_dataset: Dataset, fabricate: Any) -> None:
    (summary,) = judge(fabricate(lidar_dataset).answers(), lidar_dataset).summaries
    old = summary.model_dump(mode="json")
    old.pop("filter")
    assert Summary.model_validate(old).filter is None
    assert Summary.model_validate_json(summary.model_dump_json()) == summary


def test_seeds_pool_their_squares_and_count_what_was_lost(make_lidar: Any, tmp_path: Any, fabricate: Any) -> None:
    """Three runs with 0.1, 0.2 and 0.2 m of error in r, the last without answers at the end; NEES of known means."""
    rows, random = [], np.random.default_rng(5)
    for seed, (off_m, missing) in enumerate([(0.1, ()), (0.2, ()), (0.2, tuple(range(30, 40)))]):
        dataset = make_lidar(tmp_path / str(seed), seed=seed)
        maker = fabricate(dataset)
        stated = np.broadcast_to(maker.covariance(random), (40, 20, 20))
        answers = maker.answers(errors=_errors(40, r=off_m), covariances=stated, missing=missing)
        rows += [_row(one, f"tumble-seed{seed}") for one in judge(answers, dataset).summaries]
    (line,) = seeds_lines(rows, {f"tumble-seed{seed}": "tumble" for seed in range(3)})
    assert (line.case, line.title, len(line.rows), line.converged) == ("tumble", "exact", 3, 2)
    assert (line.answered, line.frames) == (110, 120)
    r = line.states["r"]
    assert r.worst == pytest.approx(3 * np.sqrt((0.1**2 + 0.2**2) / 2))
    assert (r.median, r.runs, r.lost, r.settled) == (pytest.approx(0.45), 3, 1, 2)
    assert not r.is_met
    assert line.states["attitude"].settled_s == 0.0
    assert line.nees is not None
    assert (line.nees.low, line.nees.high) == mean_bounds(20, 2)
    means = [row.summary.filter.nees.mean for row in rows[:2] if row.summary.filter and row.summary.filter.nees]
    assert line.nees.mean == pytest.approx(np.mean(means))
    shown = of_line(line)
    assert (shown["converged"], shown["answered"]) == ("2/3", "110/120")
    assert set(map(heading, STATES)) <= set(shown)


def test_cases_of_one_run_are_lines_of_their_own(lidar_dataset: Dataset, fabricate: Any) -> None:
    summaries = [judge(fabricate(lidar_dataset).answers(title=title), lidar_dataset).summaries[0] for title in ("a", "b")]
    lines = seeds_lines([_row(one, case) for case in ("x", "y") for one in summaries], {})
    assert [(line.case, line.title) for line in lines] == [("x", "a"), ("x", "b"), ("y", "a"), ("y", "b")]
