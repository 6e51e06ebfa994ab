"""Scores and pages are kept while nothing that they follow from has changed, and no longer."""

import shutil
from pathlib import Path

import pytest

from benchmark import freshness, results
from benchmark.case import CaseRun
from benchmark.entries import Task, answer_and_judge
from benchmark.judge import SCORES, SUMMARY
from benchmark.report import PAGE
from benchmark.results import CaseHeading, Entry, Results
from benchmark.suite import Method
from scenes.dataset import Dataset


@pytest.fixture
def task(dataset: Dataset, tmp_path: Path) -> Task:
    """An entry that is made in this process and may be kept."""
    return Task(
        run=CaseRun("one", "one", None),
        dataset=dataset.path,
        feature="panel",
        rig=None,
        lidar=None,
        title="ours",
        method=Method(estimator="mono-rectangle-paper"),
        sigma_px=3.0,
        settle_s=0.0,
        folder=tmp_path / "entry",
        limits=None,
    )


def _made(task: Task) -> int:
    answer_and_judge(task)
    return (task.folder / SCORES).stat().st_mtime_ns


def test_scores_are_kept_until_answers_rule_or_scores_change(task: Task, dataset: Dataset) -> None:
    first = _made(task)
    assert freshness.is_judged(task.folder, dataset, 0.0)
    assert not freshness.is_judged(task.folder, dataset, 1.0)
    assert _made(task) == first
    (task.folder / SUMMARY).write_text("[]", encoding="utf-8")
    assert _made(task) > first
    assert freshness.is_judged(task.folder, dataset, 0.0)
    assert (task.folder / SUMMARY).read_text(encoding="utf-8") != "[]"
    answers = task.folder / "predictions.csv"
    answers.write_bytes(answers.read_bytes() + b"\n")
    assert not freshness.is_judged(task.folder, dataset, 0.0)


def test_another_program_judges_anew(task: Task, dataset: Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    first = _made(task)
    monkeypatch.setattr(freshness, "_program", lambda: "another")
    assert not freshness.is_judged(task.folder, dataset, 0.0)
    assert _made(task) > first


def test_a_page_is_kept_until_results_or_the_page_change(task: Task, tmp_path: Path) -> None:
    answer_and_judge(task)
    entry = Entry(case="one", feature="panel", title="ours", dataset="data", answers="entry", scores="entry")
    index = Results(title="t", cases=(CaseHeading(name="one"),), entries=(entry,))
    results.write(tmp_path, index)
    assert not freshness.is_reported(tmp_path, index)
    (tmp_path / PAGE).write_text("<html>", encoding="utf-8")
    freshness.mark_reported(tmp_path, index)
    assert freshness.is_reported(tmp_path, index)
    shutil.copy(task.folder / SUMMARY, tmp_path / "kept.json")
    (task.folder / SUMMARY).write_text("[]", encoding="utf-8")
    assert not freshness.is_reported(tmp_path, index)
    shutil.copy(tmp_path / "kept.json", task.folder / SUMMARY)
    assert freshness.is_reported(tmp_path, index)
    (tmp_path / PAGE).write_text("<html><p>edited", encoding="utf-8")
    assert not freshness.is_reported(tmp_path, index)
