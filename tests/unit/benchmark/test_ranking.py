"""The published ranking against frames whose errors are made up: charges, intervals, ranks, ties, divisions."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from benchmark import metrics
from benchmark.errors import PredictionsError
from benchmark.pool import COLUMNS
from benchmark.ranking import FILE, Division, Ranking, charges, ranking, read, write
from benchmark.ranking_rule import UNANSWERED_RAD

_GUESS = 2.2074161  # π/2 + 2/π


def _rows(
    method: str,
    rotation_deg: object,
    share: object = 0.0,
    *,
    run: str = "run",
    modality: str = "lidar",
    frames: int = 60,
    **more: object,
) -> pd.DataFrame:
    """A track's rows at 50 m; a NaN of ``rotation_deg`` is a frame without an answer."""
    rotation = np.broadcast_to(np.asarray(rotation_deg, dtype=float), frames)
    answered = ~np.isnan(rotation)
    off = np.where(answered & (modality != "mono"), np.broadcast_to(np.asarray(share, dtype=float), frames), np.nan)
    speed = np.where(answered, metrics.speed_rotation(np.radians(np.nan_to_num(rotation))), np.nan)
    place = np.where(np.isnan(off), np.nan, np.where(np.nan_to_num(off) < metrics.SPEED_POSITION, 0.0, off))
    columns = {
        "case": run, "run": run, "subject": "it", "sensor": "eye", "modality": modality, "method": method,
        "frame": np.arange(frames), "answered": answered, "geodesic_deg": rotation, "position_error_m": 50.0 * off,
        "speed_rotation": speed, "speed_position": place, "score": speed + (0.0 if modality == "mono" else place),
        "wrong": answered & (np.nan_to_num(rotation) > 5.0), "cpu_s": 0.02, "range_m": 50.0,
    }  # fmt: skip
    return pd.DataFrame(columns | more)


def _one(*tracks: pd.DataFrame) -> Division:
    (found,) = ranking(pd.concat(tracks)).divisions
    return found


def _noise(seed: int, frames: int = 60) -> np.ndarray:
    return np.random.default_rng(seed).uniform(1.0, 3.0, frames)


def test_the_rows_are_columns_of_the_pool() -> None:
    assert set(_rows("a", 1.0)) <= set(COLUMNS)


@pytest.mark.parametrize(("modality", "charge"), [("mono", _GUESS), ("stereo", _GUESS + 1.0), ("lidar", _GUESS + 1.0)])
def test_a_frame_without_an_answer_is_charged_a_blind_guess(modality: str, charge: float) -> None:
    """A quarter of the frames without an answer, three quarters 3° and 1 % off."""
    rotation = np.tile([3.0, 3.0, 3.0, np.nan], 15)
    frames = _rows("a", rotation, 0.01, modality=modality)
    answer = np.radians(3.0) + (0.0 if modality == "mono" else 0.01)
    np.testing.assert_allclose(charges(frames), np.tile([answer, answer, answer, charge], 15), rtol=1e-7)
    (standing,) = _one(frames).methods
    assert standing.charge.value == pytest.approx(0.75 * answer + 0.25 * charge)
    assert (standing.frames, standing.answered, standing.availability.value) == (60, 45, 0.75)


def test_a_wrong_answer_is_charged_no_less_than_none_and_a_missing_position_as_a_guess() -> None:
    assert charges(_rows("a", 180.0, 7.0))[0] == pytest.approx(np.pi + 7.0)
    assert charges(_rows("a", 10.0, 0.0))[0] == pytest.approx(_GUESS + 1.0)
    assert charges(_rows("a", 10.0, modality="mono"))[0] == pytest.approx(_GUESS)
    assert charges(_rows("a", 4.9, 0.0))[0] == pytest.approx(np.radians(4.9))
    assert charges(_rows("a", 3.0, np.nan))[0] == pytest.approx(np.radians(3.0) + 1.0)
    assert np.isfinite(charges(_rows("a", 10.0, np.inf))).all()


def test_a_constant_answer_does_not_beat_one_that_says_when_it_cannot_tell() -> None:
    """The target turns by ±20°: always answering zero has a mean error of 10°, and is right in a quarter of the frames."""
    rotation = np.abs(np.linspace(-20, 20, 120))
    honest = np.where(np.arange(120) % 5 == 0, np.nan, 0.3)
    found = _one(_rows("constant", rotation, modality="mono", frames=120), _rows("honest", honest, modality="mono", frames=120))
    assert [(one.method, one.rank) for one in found.methods] == [("honest", 1), ("constant", 2)]


def test_guessing_at_random_gains_nothing() -> None:
    """Of 200 000 random rotations the mean angle's standard error is 0.0015 rad."""
    angles = Rotation.random(200_000, rng=np.random.default_rng(3)).magnitude()
    assert angles.mean() == pytest.approx(UNANSWERED_RAD, abs=0.006)
    guesses = np.degrees(angles[:2000])
    found = _one(_rows("guess", guesses, modality="mono", frames=2000), _rows("silent", np.nan, modality="mono", frames=2000))
    assert [one.method for one in found.methods] == ["silent", "guess"]


def test_the_truth_is_perfect_in_every_figure() -> None:
    (standing,) = _one(_rows("truth", 0.0)).methods
    figures = standing.model_dump(exclude={"method", "rank", "is_tied", "frames", "answered", "availability", "cpu_ms"})
    assert len(figures) == 8
    for name, figure in figures.items():
        assert figure == {"value": 0.0, "low": 0.0, "high": 0.0}, name
    assert standing.availability.model_dump() == {"value": 1.0, "low": 1.0, "high": 1.0}
    assert (standing.rank, standing.is_tied) == (1, False)


def test_figures_are_of_the_errors_over_all_frames() -> None:
    rotation = np.where(np.arange(60) % 10 == 0, 8.0, _noise(1))
    (standing,) = _one(_rows("a", rotation, 0.004 * _noise(2))).methods
    assert standing.rotation_median_deg.value == pytest.approx(np.median(rotation))
    assert standing.rotation_p95_deg.value == pytest.approx(np.quantile(rotation, 0.95))
    assert standing.position_median_m is not None
    assert standing.position_median_m.value == pytest.approx(50.0 * 0.004 * np.median(_noise(2)))
    assert standing.position_p95_share is not None
    assert standing.position_p95_share.value == pytest.approx(0.004 * np.quantile(_noise(2), 0.95))
    assert standing.wrong.value == pytest.approx(0.1)
    assert standing.cpu_ms is not None
    assert standing.cpu_ms.value == pytest.approx(20.0)
    low, high = standing.rotation_median_deg.low, standing.rotation_median_deg.high
    assert low is not None
    assert high is not None
    assert low < np.median(rotation) < high


def test_a_quantile_among_the_unanswered_has_no_value_and_a_bound_may_lie_there() -> None:
    rotation = np.where(np.arange(60) % 2 == 0, 1.0, np.nan)  # just half: the median is between an error and none
    (half,) = _one(_rows("half", rotation, modality="stereo")).methods
    for figure in (half.rotation_median_deg, half.rotation_p95_deg, half.position_median_m, half.position_p95_share):
        assert figure is not None
        assert figure.value is None
    seldom = np.where(np.random.default_rng(7).permutation(200) < 8, np.nan, 1.0)
    (most,) = _one(_rows("most", seldom, frames=200)).methods
    assert most.rotation_p95_deg.model_dump() == {"value": 1.0, "low": 1.0, "high": None}
    assert most.rotation_median_deg.high == 1.0


def test_a_rectangle_has_no_position_and_what_nobody_timed_no_cpu_time() -> None:
    (standing,) = _one(_rows("a", 1.0, modality="mono", cpu_s=np.nan)).methods
    assert standing.position_median_m is None
    assert standing.position_p95_share is None
    assert standing.cpu_ms is None
    half = np.where(np.arange(60) < 30, np.nan, 0.03)
    (timed,) = _one(_rows("a", 1.0, cpu_s=half)).methods
    assert timed.cpu_ms is not None
    assert timed.cpu_ms.value == pytest.approx(30.0)


def test_a_method_ties_with_itself() -> None:
    found = _one(_rows("a", _noise(1)), _rows("b", _noise(1)), _rows("worse", 9.0))
    assert [(one.method, one.rank, one.is_tied) for one in found.methods] == [("a", 1, True), ("b", 1, True), ("worse", 3, False)]
    difference = found.differences[0]
    assert (difference.first, difference.second, difference.better, difference.worse) == ("a", "b", None, None)
    assert difference.charge.model_dump() == {"value": 0.0, "low": 0.0, "high": 0.0}


def test_a_small_margin_in_every_frame_decides_where_the_intervals_overlap() -> None:
    hard = 1.4 * _noise(4)  # some frames are far harder than others, for both
    found = _one(_rows("worse", hard + 0.1 + 0.05 * _noise(5)), _rows("better", hard))
    first, second = found.methods
    assert [(one.method, one.rank, one.is_tied) for one in found.methods] == [("better", 1, False), ("worse", 2, False)]
    assert first.charge.high is not None
    assert second.charge.low is not None
    assert first.charge.high > second.charge.low
    (difference,) = found.differences
    assert difference.charge.value == pytest.approx(-np.radians(0.1 + 0.05 * _noise(5).mean()))
    assert (difference.better, difference.worse) == ("better", "worse")


def test_no_better_on_average_is_a_tie() -> None:
    swing = np.where(np.random.default_rng(8).random(60) < 0.5, 1.0, -1.0)
    found = _one(_rows("a", 5.0 + swing), _rows("b", 5.0 - swing))
    assert [one.rank for one in found.methods] == [1, 1]
    assert all(one.is_tied for one in found.methods)


def test_a_rank_counts_the_methods_that_are_better() -> None:
    """a ~ b and b ~ c, but a is better than c: a and b are first, c is second."""
    rng = np.random.default_rng(9)
    wide = np.clip(2.5 + 0.9 * rng.standard_normal(60), 0.2, 4.8)
    found = _one(_rows("a", np.full(60, 2.47)), _rows("b", wide), _rows("c", np.full(60, 2.53)))
    better = {(one.first, one.second): one.better for one in found.differences}
    assert better == {("a", "b"): None, ("b", "c"): None, ("a", "c"): "a"}
    assert {one.method: (one.rank, one.is_tied) for one in found.methods} == {"a": (1, True), "b": (1, True), "c": (2, False)}


def test_the_order_of_rows_changes_nothing() -> None:
    frames = pd.concat([
        _rows(method, level * _noise(seed), 0.01, run=run, modality=modality)
        for seed, (method, level) in enumerate([("c", 1.0), ("a", 1.3), ("b", 1.1)])
        for run, modality in (("y", "lidar"), ("x", "lidar"), ("x", "mono"))
    ])  # fmt: skip
    shuffled = frames.sample(frac=1.0, random_state=1)
    assert ranking(frames) == ranking(frames)
    assert ranking(shuffled) == ranking(frames)


def test_methods_are_compared_on_what_all_of_them_saw() -> None:
    """Two on two LIDAR runs, another two on a third; a lone one on a ring and on a rectangle."""
    tracks = [_rows(method, 1.0, run=run, frames=30) for method in ("a", "b") for run in ("one", "two")]
    tracks += [_rows(method, 1.0, run="three", frames=90) for method in ("a", "c")]
    tracks += [
        _rows("d", 1.0, run="one", modality="stereo", subject="ring"),
        _rows("d", 1.0, run="one", modality="mono", subject="wing"),
    ]
    found = ranking(pd.concat(tracks)).divisions
    assert [(one.modality, one.frames, one.tracks) for one in found] == [
        ("mono", 60, 1), ("stereo", 60, 1), ("lidar", 90, 1), ("lidar", 60, 2),
    ]  # fmt: skip
    assert [[one.method for one in part.methods] for part in found] == [["d"], ["d"], ["a", "c"], ["a", "b"]]
    assert (found[3].cases, found[3].subjects) == (("one", "two"), ("it",))
    assert found[0].differences == ()
    assert (found[0].methods[0].rank, found[0].methods[0].is_tied) == (1, False)


def test_a_frame_that_a_method_leaves_out_is_one_without_an_answer() -> None:
    found = _one(_rows("all", 1.0), _rows("some", 1.0).iloc[:45])
    assert {one.method: one.answered for one in found.methods} == {"all": 60, "some": 45}
    assert {one.frames for one in found.methods} == {60}
    assert found.methods[1].charge.value == pytest.approx(0.75 * np.radians(1.0) + 0.25 * (_GUESS + 1.0))


def test_two_entries_of_one_name_on_the_same_frames_are_refused() -> None:
    with pytest.raises(PredictionsError, match="two entries are called 'a' and answer frame 0 of run, it, eye"):
        ranking(pd.concat([_rows("a", 1.0), _rows("a", 2.0)]))


def test_two_frames_are_too_few_to_tell() -> None:
    found = _one(_rows("a", 1.0, frames=2), _rows("b", 2.0, frames=2))
    assert [one.rank for one in found.methods] == [1, 1]
    assert found.methods[0].charge.model_dump() == {"value": pytest.approx(np.radians(1.0)), "low": None, "high": None}


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    found = ranking(pd.concat([_rows("a", _noise(1)), _rows("<b>", np.nan), _rows("c", 1.0, modality="mono")]))
    write(tmp_path, found)
    assert read(tmp_path) == found
    assert found.rule.unanswered_rad == pytest.approx(_GUESS)
    assert (found.rule.resamples, found.rule.unanswered_share_of_range) == (1000, 1.0)


def test_no_results_are_no_divisions_and_no_ranking_is_a_sentence(tmp_path: Path) -> None:
    assert ranking(pd.DataFrame(columns=list(COLUMNS))) == Ranking()
    with pytest.raises(PredictionsError, match=r"holds no ranking\.json"):
        read(tmp_path)
    (tmp_path / FILE).write_text('{"format": "something"}')
    with pytest.raises(PredictionsError, match=r"ranking\.json is damaged: format"):
        read(tmp_path)
