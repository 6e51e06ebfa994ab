"""Efficiency on the leaderboard: answers that scatter as their bound says have 1, at twice the spread 1/4; and who has none."""

from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from benchmark import bench, judge, predictions, ranking, results
from benchmark.bound_scores import seen_by
from benchmark.information import table
from benchmark.information.fisher import AXES
from benchmark.pool import pool
from benchmark.pose_errors import error_vectors
from benchmark.predictions import QUATERNION, TRANSLATION
from benchmark.ranking import Ranking, Standing
from benchmark.ranking_cells import cells, legend
from benchmark.report_board import boards
from benchmark.results import CaseHeading, Entry, Results
from benchmark.suite import load_suite
from scenes.dataset import Dataset
from scenes.errors import ConfigError
from scenes.recording import StereoPair

FRAMES = 200
SQUARES = {"mono": ("bound_chi2_attitude", 3), "lidar": ("bound_chi2_pose", 6), "stereo": ("bound_chi2_pose", 6)}
_CHI2_95_OF_3 = 7.815


def _rows(method: str, squares: np.ndarray, modality: str = "lidar", run: str = "run") -> pd.DataFrame:
    """A track of good answers whose squared errors in units of their bound are ``squares`` (n,), NaN: no bound."""
    name, other = ("bound_chi2_attitude", "bound_chi2_pose")[:: 1 if modality == "mono" else -1]
    charge = np.random.default_rng(9).uniform(1e-3, 2e-3, len(squares))
    columns = {
        "case": run, "run": run, "subject": "it", "sensor": "eye", "modality": modality, "method": method,
        "frame": np.arange(len(squares)), "answered": True, "geodesic_deg": 0.1, "position_error_m": 0.01, "speed_rotation": charge,
        "speed_position": 1e-3, "score": 2e-3, "wrong": False, "cpu_s": 0.02, "range_m": 50.0, name: squares, other: 1e9,
    }  # fmt: skip
    return pd.DataFrame(columns)


def _drawn(degrees: int, seed: int, frames: int = FRAMES) -> np.ndarray:
    return np.random.default_rng(seed).chisquare(degrees, frames)


def _standings(*tracks: pd.DataFrame) -> dict[str, Standing]:
    (division,) = ranking.ranking(pd.concat(tracks, ignore_index=True)).divisions
    return {one.method: one for one in division.methods}


@pytest.mark.parametrize("modality", SQUARES)
def test_an_ideal_estimator_has_one_in_its_interval_and_one_of_twice_its_spread_a_quarter(modality: str) -> None:
    squares = _drawn(SQUARES[modality][1], 1)
    tracks = {"ideal": squares, "twice": 4 * squares, "other": np.nan * squares}
    found = _standings(*(_rows(method, one, modality) for method, one in tracks.items()))
    ideal, twice = found["ideal"].efficiency, found["twice"].efficiency
    assert ideal is not None
    assert twice is not None
    assert None not in (ideal.value, ideal.low, ideal.high)
    assert ideal.low < 1.0 < ideal.high < 2 * ideal.low  # type: ignore[operator]
    assert (twice.value, twice.low, twice.high) == pytest.approx((ideal.value / 4, ideal.low / 4, ideal.high / 4))  # type: ignore[operator]
    assert found["other"].efficiency is None


def test_the_interval_is_as_wide_as_other_frames_would_have_made_it() -> None:
    """Of 200 independent frames the spread of the median of χ²₆, with density 0.123 there, is 1/(2 · 0.123 √200)."""
    found = [_standings(_rows("a", _drawn(6, seed)))["a"].efficiency for seed in range(25)]
    half = [(one.high - one.low) / 2 / one.value for one in found if one is not None]  # type: ignore[operator]
    assert np.mean(half) == pytest.approx(1.96 / (2 * 0.123 * np.sqrt(200)) / 5.348, rel=0.15)


def test_only_frames_with_a_bound_count_and_fewer_than_thirty_are_no_figure() -> None:
    squares = _drawn(6, 2)
    some = np.where(np.arange(FRAMES) % 5 == 0, squares, np.nan)
    few = np.where(np.arange(FRAMES) < 29, squares, np.nan)
    found = _standings(_rows("some", some), _rows("few", few))
    assert found["some"].efficiency is not None
    assert found["some"].efficiency.value == pytest.approx(5.348 / np.median(squares[::5]))
    assert found["few"].efficiency is None


def test_rankings_without_bounds_are_written_as_they_were_and_read(tmp_path: Path) -> None:
    rows = _rows("a", np.full(40, np.nan))
    found = ranking.ranking(rows.drop(columns=["bound_chi2_attitude", "bound_chi2_pose"]))
    ranking.write(tmp_path, found)
    assert "efficiency" not in (tmp_path / ranking.FILE).read_text()
    assert ranking.read(tmp_path) == found
    bounded = ranking.ranking(_rows("a", _drawn(6, 3)))
    ranking.write(tmp_path, bounded)
    assert ranking.read(tmp_path) == bounded


def _shown(found: Ranking) -> tuple[list[str], list[str]]:
    """Headings in the console and on the page."""
    board = boards(found, ["a", "b"], {})[0]
    return list(cells(found.divisions[0])[0]), [column.name for column in board.columns]


def test_it_is_shown_where_any_is_known() -> None:
    without = ranking.ranking(_rows("a", np.full(40, np.nan)))
    found = ranking.ranking(pd.concat([_rows("a", np.full(FRAMES, np.nan)), _rows("b", _drawn(6, 4))]))
    assert "effi-\nciency" not in _shown(without)[0]
    assert "efficiency" not in _shown(without)[1]
    assert "Efficiency" not in legend(without)
    assert "effi-\nciency" in _shown(found)[0]
    assert "efficiency" in _shown(found)[1]
    assert "Efficiency" in legend(found)
    texts = {line["method"].split()[-1]: line["effi-\nciency"] for line in cells(found.divisions[0])}
    assert texts["a"] == "—"
    assert texts["b"].startswith(("0.", "1."))


def _bounds(dataset: Dataset, covariance: np.ndarray, sensor: str = "nav") -> pd.DataFrame:
    """A bound of every frame, the same for all; that of the last is undetermined."""
    information = np.linalg.inv(covariance)
    row = {f"information_{AXES[a]}_{AXES[b]}": information[a, b] for a, b in table.UPPER}
    traces = {"sigma_rotation_rad": covariance[:3, :3], "sigma_position_m": covariance[3:, 3:]}
    sigmas = {name: np.sqrt(np.trace(block)) for name, block in traces.items()}
    rows = pd.DataFrame([{"frame": frame, "sensor": sensor, **row, **sigmas} for frame in dataset.frames])
    rows.loc[rows.index[-1], list(sigmas)] = np.nan
    return rows


def test_judged_answers_drawn_from_their_bound_have_efficiency_one(
    make_dataset: Callable[..., Dataset], submit: Callable[..., Path], tmp_path: Path
) -> None:
    """Turns in camera axes with an uneven covariance, and answers that take the other labelling of a target with symmetry."""
    dataset = make_dataset(tmp_path / "data", frames=range(80))
    mixing = np.random.default_rng(5).normal(size=(6, 6)) * np.array([1e-3, 3e-3, 1e-2, 0.1, 0.2, 0.3])[:, None]
    covariance = mixing @ mixing.T
    turns = np.random.default_rng(6).multivariate_normal(np.zeros(6), covariance, 80)[:, :3]
    true = Rotation.from_quat(dataset.truth_table()[list(QUATERNION)].to_numpy(), scalar_first=True)
    entries = []
    for title, scale, label in (("ideal", 1.0, 0.0), ("twice", 2.0, 0.0), ("upside down", 1.0, np.pi)):
        other = true.inv() * Rotation.from_rotvec(scale * turns) * true * Rotation.from_rotvec([label, 0, 0])
        folder = submit(dataset, tmp_path / title, title, other)
        judge.write(folder, judge.judge(predictions.read(folder), dataset, bounds=_bounds(dataset, covariance)))
        entries.append(Entry(case="turn", feature="panel", title=title, dataset="data", answers=title, scores=title))
    scores = pd.read_parquet(tmp_path / "ideal" / judge.SCORES)
    assert scores["bound_rotation_rad"][:-1].to_numpy() == pytest.approx(np.sqrt(np.trace(covariance[:3, :3])))
    expected = np.einsum("ni,ij,nj->n", turns, np.linalg.inv(covariance[:3, :3]), turns)
    np.testing.assert_allclose(scores["bound_chi2_attitude"][:-1], expected[:-1], rtol=1e-6)
    assert (expected < _CHI2_95_OF_3).mean() > 0.85
    assert np.isnan(scores["bound_chi2_attitude"].iloc[-1])
    assert scores["bound_chi2_pose"].isna().all()  # no position was given
    index = Results(title="t", cases=(CaseHeading(name="turn"),), entries=tuple(entries))
    (division,) = ranking.ranking(pool(tmp_path, index)).divisions
    found = {one.method: one.efficiency for one in division.methods}
    assert found["ideal"] is not None
    assert found["ideal"].low < 1.0 < found["ideal"].high  # type: ignore[operator]
    assert found["twice"].value == pytest.approx(found["ideal"].value / 4, rel=1e-6)  # type: ignore[union-attr, operator]
    assert found["upside down"].value == pytest.approx(found["ideal"].value, rel=1e-6)  # type: ignore[union-attr]


def test_scores_without_bounds_are_as_they_were(dataset: Dataset, submit: Callable[..., Path], tmp_path: Path) -> None:
    folder = submit(dataset, tmp_path / "a", "a", Rotation.identity())
    assert not [name for name in judge.judge(predictions.read(folder), dataset).scores if name.startswith("bound")]


def test_a_ring_that_takes_another_marker_is_turned_back_about_its_own_centre() -> None:
    rng, centre = np.random.default_rng(7), np.array([0.3, -0.2, 0.9])
    turn = Rotation.from_rotvec([0, 0, 2.0])
    true, places = Rotation.random(6, rng=rng), np.array([0, 0, 20]) + rng.normal(size=(6, 3))
    given, there = true * turn, places + true.apply(centre) - (true * turn).apply(centre)
    moved = Rotation.from_rotvec(rng.normal(scale=1e-4, size=(6, 3)))
    shift = rng.normal(scale=1e-3, size=(6, 3))
    about_the_origin = moved * given, there + shift + (moved * given).apply(-centre) - given.apply(-centre)
    labels = Rotation.concatenate([Rotation.identity(), turn])

    def poses(rotation: Rotation, place: np.ndarray) -> pd.DataFrame:
        return pd.DataFrame(np.hstack([rotation.as_quat(scalar_first=True), place]), columns=[*QUATERNION, *TRANSLATION])

    found = error_vectors(poses(true, places), poses(*about_the_origin), np.ones(6, dtype=bool), labels, centre)
    np.testing.assert_allclose(found[:, :3], moved.as_rotvec(), atol=1e-9)
    ring = places + true.apply(centre)
    back = about_the_origin[1] + about_the_origin[0].apply(centre) - ring
    np.testing.assert_allclose(found[:, 3:], back - (moved * true).apply(centre) + true.apply(centre), atol=1e-9)


def test_a_rig_sees_what_its_left_camera_answers_for() -> None:
    dataset: Any = SimpleNamespace(rigs={"eyes": StereoPair("a", "b", None)})  # type: ignore[arg-type]
    assert [seen_by(dataset, name) for name in ("a", "b", "nav")] == ["eyes", "b", "nav"]


SUITE = """
title = "t"
description = "d"
quality = "draft"
bounds = "0::2"
[methods.ours]
estimator = "mono-rectangle"
[[cases]]
name = "turn"
scenario = "zhai2014-in-plane"
frames = "419:422"
features = ["wing"]
"""


def test_a_suite_finds_the_bounds_that_it_asks_for_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[list[int], list[str]]] = []

    def stand_in(dataset: Dataset, frames: list[int], sensors: list[str], *_: Any, **__: Any) -> Iterator[list[dict[str, Any]]]:
        asked.append((frames, sensors))
        (known, *_) = _bounds(dataset, np.diag([1e-8] * 3 + [1e-4] * 3), sensors[0]).to_dict("records")
        numbers = {name: value for name, value in known.items() if isinstance(value, float)}
        yield [known]
        yield [known | dict.fromkeys(numbers, float("nan")) | {"frame": frames[1]}]  # undetermined

    monkeypatch.setattr(table, "frame_rows", stand_in)
    (tmp_path / "s.toml").write_text(SUITE)
    for _ in range(2):
        index = bench.bench(load_suite(str(tmp_path / "s.toml")), tmp_path / "out", in_process=True)
    assert asked == [([419, 421], ["nav"])]
    assert (tmp_path / "out" / "bounds" / "turn.parquet").is_file()
    scores = pd.read_parquet(tmp_path / "out" / index.entries[0].scores / judge.SCORES)
    np.testing.assert_allclose(scores["bound_rotation_rad"], [np.sqrt(3e-8), np.nan, np.nan])
    assert results.read(tmp_path / "out") == index


def test_bounds_of_frames_that_a_case_does_not_have_are_refused(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text(SUITE.replace("0::2", "0:7"))
    with pytest.raises(ConfigError, match="turn"):
        load_suite(str(tmp_path / "s.toml"))
    (tmp_path / "s.toml").write_text(SUITE.replace('bounds = "0::2"', "").replace('name = "turn"', 'name = "turn"\nbounds = "2:9"'))
    with pytest.raises(ConfigError, match="bounds"):
        load_suite(str(tmp_path / "s.toml"))
