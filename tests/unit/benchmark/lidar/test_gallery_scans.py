"""Scans for the page: packed points decode to those of the scan, boxes stand at the poses, empty scans are not chosen."""

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark import gallery_scans, judge, predictions
from benchmark.gallery_answers import Answers
from benchmark.gallery_lidars import Reading
from benchmark.gallery_scans import choose_scans, packed
from benchmark.pool import pool
from benchmark.report_gallery import Gallery, gallery
from benchmark.results import CaseHeading, Entry, Results
from scenes.dataset import Dataset

OWN = RigidTransform.from_components([0.7, -0.4, 1.1], Rotation.from_euler("xyz", [25.0, 60.0, -110.0], degrees=True))


def _points(data: dict[str, Any]) -> np.ndarray:
    grid = np.frombuffer(base64.b64decode(data["xyz"]), dtype="<i2").reshape(-1, 3)
    return np.array(data["origin"]) + data["step"] * grid


def _bytes(data: dict[str, Any], name: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(data[name]), dtype=np.uint8)


@pytest.fixture(scope="module")
def folder(lidar_dataset: Dataset, fabricate: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of a method that answers in a frame of its own, and drifts."""
    out = tmp_path_factory.mktemp("results")
    errors = np.zeros((len(lidar_dataset.frames), 20))
    errors[:, 0] = 0.02 * np.arange(len(errors))
    answers = fabricate(lidar_dataset).answers(OWN, errors, title="drift")
    predictions.write(out / "drift", answers)
    judge.write(out / "drift", judge.judge(answers, lidar_dataset))
    return out


@pytest.fixture(scope="module")
def index(lidar_dataset: Dataset) -> Results:
    entry = Entry(case="tumble", feature=None, title="drift", dataset=str(lidar_dataset.path), answers="drift", scores="drift")
    return Results(title="A scan", cases=(CaseHeading(name="tumble"),), entries=(entry,))


@pytest.fixture(scope="module")
def shown(folder: Path, index: Results) -> Gallery:
    return gallery(folder, index, pool(folder, index), ["drift"])


def test_packed_points_decode_to_the_scan_within_the_quantisation(lidar_dataset: Dataset) -> None:
    reading = Reading.of(lidar_dataset, "lidar", 5)
    data = packed(reading)
    points, lost = _points(data), _bytes(data, "lost") > 0
    true = reading.points_lidar[reading.has_return]
    assert data["count"] == len(points)
    assert np.abs(points[~lost] - true).max() <= data["step"] / 2 + 1e-9
    assert data["step"] < 1e-3
    strength = _bytes(data, "strength")[~lost]
    order = np.argsort(reading.strength[reading.has_return], kind="stable")
    assert (np.diff(strength[order].astype(int)) >= 0).all()
    np.testing.assert_array_equal(_bytes(data, "fate")[~lost], reading.fates[reading.has_return])
    if lost.any():
        beams = np.flatnonzero(~reading.has_return & (reading.fates != 255))
        away = np.linalg.norm(points[lost], axis=1) - reading.truth["range_m"][beams]
        assert np.abs(away).max() < 2 * data["step"]


def test_a_scan_of_too_many_points_is_thinned_evenly(lidar_dataset: Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    reading = Reading.of(lidar_dataset, "lidar", 5)
    whole = _points(packed(reading))
    monkeypatch.setattr(gallery_scans, "MOST_POINTS", 40)
    few = packed(reading)
    assert few["count"] == 40
    assert np.abs(_points(few)[:, None] - whole[None]).max(axis=-1).min(axis=1).max() <= 2e-3
    assert np.allclose(_points(few).mean(axis=0), whole.mean(axis=0), atol=0.4)


def test_the_scan_says_what_it_holds_and_its_boxes_stand_at_the_true_and_the_answered_pose(
    shown: Gallery, lidar_dataset: Dataset
) -> None:
    (scan,) = shown.scans
    frame = int(scan.heading.rsplit(" ", 1)[1])
    reading = Reading.of(lidar_dataset, "lidar", frame)
    assert reading.has_return.sum() == 82
    assert scan.alternative.startswith("81 returns between ")  # one is noise
    assert "beams lost on it: 9 too grazing;" in scan.alternative
    true, answered = scan.data["poses"]
    assert (true["series"], answered["series"], answered["name"]) == (None, 0, "drift")
    np.testing.assert_allclose(true["axes"][0], reading.true.translation, atol=1e-3)
    centre = np.mean(true["corners"], axis=0)
    np.testing.assert_allclose(np.linalg.norm(np.array(true["corners"]) - centre, axis=1).std(), 0, atol=2e-3)
    turned = np.array([np.diff(np.array(pose["axes"])[[0, 1]], axis=0)[0] for pose in (true, answered)])
    cosine = turned[0] @ turned[1] / np.prod(np.linalg.norm(turned, axis=1))
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))) < np.degrees(0.02 * frame) + 0.1
    assert "--frames" in scan.command
    assert str(lidar_dataset.path) not in scan.command


def test_a_lidars_card_has_its_layers_and_both_outlines(shown: Gallery) -> None:
    (shelf,) = shown.shelves
    assert shelf.name == "LIDAR"
    card = shelf.items[0]
    assert [layer.key for layer in card.layers] == ["picture", "fate", "range"]
    assert card.kinds == ("true", "answered")
    assert card.size < 60_000


def test_scans_without_returns_are_passed_over(
    folder: Path, index: Results, lidar_dataset: Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames, truth = pool(folder, index), lidar_dataset.truth_table()
    truth["returns"] = 0.0
    truth.loc[truth["frame"].isin([3, 7]), "returns"] = [10.0, 9.0]
    monkeypatch.setattr(Dataset, "truth_table", lambda _: truth)
    (chosen,) = choose_scans(frames, Answers(folder))
    assert set(chosen["frame"]) == {7}  # of the two with returns the one that is answered worse
    truth["returns"] = 0.0
    assert choose_scans(frames, Answers(folder)) == ()


def test_scans_are_spread_over_the_cases(folder: Path, index: Results, make_lidar: Callable[..., Dataset]) -> None:
    frames = pool(folder, index)
    many = pd.concat([frames.assign(case=f"case{n}", run=f"case{n}") for n in range(9)], ignore_index=True)
    chosen = choose_scans(many, Answers(folder))
    assert [one["case"].iloc[0] for one in chosen] == ["case0", "case3", "case5", "case8"]
    frame_of = [int(one["frame"].iloc[0]) for one in chosen]
    assert len(set(frame_of)) == 4  # these cases have the same scans: none is shown twice
    score = frames.set_index("frame")["score"]
    assert (np.diff(score[frame_of]) <= 0).all()
    assert choose_scans(many[many["frame"] == 3], Answers(folder))[1:] == ()
