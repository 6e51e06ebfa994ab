"""Parts of the page: links made of any name, commands without a machine's paths, and a case of cameras and seeds in one table."""

from pathlib import Path
from typing import Any

import pytest

from benchmark import judge, predictions, report, results
from benchmark.knowledge import declare
from benchmark.made_by import UNKNOWN, command, named
from benchmark.pool import pool
from benchmark.records import RunRecord
from benchmark.report_pooled import pooled_lines
from benchmark.results import CaseHeading, Entry, Results
from benchmark.run import answer
from benchmark.slugs import slugs
from estimators.api import Estimate, Outcome
from scenes.dataset import Dataset
from scenes.recording import Observation


def test_slugs_are_plain_and_each_name_has_its_own() -> None:
    names = ["a b", "a-b", "A/B", "<img src=x>", "…", "δ", "a-b-2"]
    found = slugs(names, "method-")
    assert found["a-b"] == "method-a-b"
    assert found["a-b-2"] == "method-a-b-2"
    assert found["<img src=x>"] == "method-img-src-x"
    assert len(set(found.values())) == len(names)
    assert all(one.replace("-", "").isalnum() and one.isascii() for one in found.values())


def test_commands_are_quoted_and_name_no_folder_of_this_machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert command("bench", named("quick"), "--out", Path("out/quick")) == "hardlight bench quick --out out/quick"
    assert command("bench", named("suites/my own.toml"), "--out", tmp_path / "o") == "hardlight bench 'suites/my own.toml' --out o"
    assert command("judge", tmp_path.parent / "answers", "--out", tmp_path) == f"hardlight judge answers --out {tmp_path.name}"


def test_results_without_a_command_are_written_as_they_were() -> None:
    assert "command" not in Results(title="t", cases=(), entries=()).model_dump_json()
    assert '"command":"c"' in Results(title="t", command="c", cases=(), entries=()).model_dump_json()


def test_a_case_of_a_camera_with_two_seeds_is_one_line_a_method(dataset: Dataset, toy: Any, tmp_path: Path) -> None:
    class Half(toy):  # type: ignore[misc]
        def step(self, observation: Observation) -> Estimate:
            if observation.frame >= 10:
                return Estimate("nav", Outcome.NO_FEATURES, reason=f"frame {observation.frame} is dark")
            found: Estimate = super().step(observation)
            return found

    entries = []
    for seed in (0, 1):
        declared = declare(dataset, "panel")
        record = RunRecord(
            format="hardlight-predictions", version=1, method="half", dataset_identity=dataset.identity, knowledge=declared.record
        )
        answers, place = answer(Half(), dataset, declared.knowledge, record), f"half-{seed}"
        predictions.write(tmp_path / place, answers)
        judge.write(tmp_path / place, judge.judge(answers, dataset))
        paths = {"dataset": str(dataset.path), "answers": place, "scores": place}
        entries.append(Entry(case=f"turn-seed{seed}", feature="panel", title="half", **paths))
    headings = tuple(CaseHeading(name=f"turn-seed{seed}", base="turn", seed=seed) for seed in (0, 1))
    index = Results(title="two seeds", cases=headings, entries=tuple(entries))
    results.write(tmp_path, index)
    (line,) = pooled_lines(pool(tmp_path, index), ["half"])
    assert (line.answered, line.frames, line.seeds) == (20, 42, 2)
    assert line.rotation_median_deg == line.rotation_p95_deg == line.position_median_m == "—"
    page = report.write(tmp_path).read_text(encoding="utf-8")
    assert page.count('<table class="pooled">') == 1
    assert 'class="rectangles"' not in page
    assert page.count("<figcaption>frame") == 1  # what the methods see, once
    assert "<b>22</b> no_features: frame 10 is dark" in page  # reasons that differ in a number count together
    assert UNKNOWN in page
