"""Methods that never began are named with their reason; those that only fail are not."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmark.results import CaseHeading, Entry, Results
from benchmark.unstarted import unstarted
from scenes.dataset import Dataset


def test_methods_that_could_not_start_are_named(
    dataset: Dataset, toy: Any, judged_entry: Callable[..., Entry], tmp_path: Path
) -> None:
    made = {"works": toy(), "unlicensed": toy("start"), "late": toy("sensor")}
    entries = [judged_entry(dataset, tmp_path, name, name, method) for name, method in made.items()]
    entries.append(judged_entry(dataset, tmp_path, "another", "unlicensed", toy()))
    index = Results(title="t", cases=(CaseHeading(name="turn"),), entries=tuple(entries))
    assert list(unstarted(tmp_path, index)) == [
        "unlicensed could not start in 1 of 2 entries; the first reason: RuntimeError: no licence"
    ]
