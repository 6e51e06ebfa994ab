"""The real command line from end to end: what each verb leaves behind, what it says, how it ends."""

import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from estimators import registry
from scenes.dataset_manifest import read_manifest

VERBS = ("demo", "doctor", "list", "render", "verify", "estimate", "check", "conform", "judge", "bench", "report", "study", "worst")
VERBS += ("archive", "reproduce", "bound")
HEAVY = ("numpy", "scipy", "pandas", "pyarrow", "matplotlib", "cv2", "mitsuba", "drjit", "pydantic", "jinja2", "trimesh")
SUITE = """
title = "Tiny"
description = "Two settings of one method on six frames"

[methods.raw]
estimator = "mono-rectangle"

[methods.filtered]
estimator = "mono-rectangle"
parameters = { filter = true }

[[cases]]
name = "slice"
scenario = "./tiny.toml"
frames = "1:6:2"
features = ["wing", "span"]
"""


def _command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "benchmark.cli", *map(str, arguments)]


def test_help_is_quick() -> None:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(_command("--help"), check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime) <= 0.5


def test_the_command_line_imports_nothing_heavy() -> None:
    code = f"import sys, benchmark.cli; print(sorted(set({HEAVY!r}) & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"


def test_help_names_every_verb_and_nothing_else(hardlight: Callable[..., Any]) -> None:
    ended = hardlight("--help")
    assert ended.status == 0
    listed = re.findall(r"^  (\w+)  ", ended.out.split("Commands:")[1], flags=re.MULTILINE)
    assert tuple(listed) == VERBS


@pytest.mark.parametrize("verb", VERBS)
def test_each_verb_has_an_example(verb: str, hardlight: Callable[..., Any]) -> None:
    ended = hardlight(verb, "--help")
    assert ended.status == 0
    assert f"Example:\n    hardlight {verb}" in ended.out


def test_version(hardlight: Callable[..., Any]) -> None:
    assert re.fullmatch(r"hardlight \d+\.\d+\.\d+\S*\n", hardlight("--version").out)


def test_list_names_everything_with_a_line(hardlight: Callable[..., Any]) -> None:
    ended = hardlight("list")
    assert ended.status == 0
    for name in ("zhai2014-in-plane", "mono-rectangle-paper", "demo", "zhai2014-target", "guppy-f125b", "white-paint"):
        (line,) = [line for line in ended.out.splitlines() if line.split()[:1] == [name]]
        assert len(line.split()) > 2
    assert "zhai2014-in-plane" not in hardlight("list", "cameras").out


def test_doctor_finds_a_backend_and_every_package(hardlight: Callable[..., Any]) -> None:
    ended = hardlight("doctor")
    assert ended.status == 0
    assert re.search(r"mitsuba +3\.\d", ended.out)
    assert re.search(r"backend +(llvm|cuda|scalar)", ended.out)


def test_doctor_says_what_to_do_where_llvm_is_missing() -> None:
    environment = os.environ | {"DRJIT_LIBLLVM_PATH": "/nonexistent.so"}
    done = subprocess.run(_command("doctor"), check=False, capture_output=True, text=True, env=environment)
    if Path("/proc/driver/nvidia/version").exists():
        pytest.skip("a GPU needs no LLVM")
    assert done.returncode == 0
    assert "scalar_rgb" in done.stdout
    assert "apt-get install libllvm" in done.stdout


def test_verify_finds_nothing_in_what_render_wrote(tiny_dataset: Path, hardlight: Callable[..., Any]) -> None:
    ended = hardlight("verify", tiny_dataset, "--sample", 2, "--quiet")
    assert (ended.status, ended.out) == (0, f"{tiny_dataset}: no fault found\n")


def test_estimate_judge_report(tiny_dataset: Path, tmp_path: Path, hardlight: Callable[..., Any]) -> None:
    answers, scores = tmp_path / "answers", tmp_path / "scores"
    ended = hardlight("estimate", "mono-rectangle", tiny_dataset, "--feature", "span", "--out", answers, "--quiet")
    assert (ended.status, ended.err) == (0, "")
    assert re.fullmatch(rf"{re.escape(str(answers))}: [4-6] ok(, \d no_features)?\n", ended.out)
    record = json.loads((answers / "run.json").read_text())
    assert record["knowledge"]["feature"] == "span"
    assert record["dataset_identity"] == json.loads((tiny_dataset / "manifest.json").read_text())["identity"]
    ended = hardlight("judge", answers, tiny_dataset, "--out", scores)
    assert ended.status == 0
    assert re.search(r"span +mono-rectangle +[4-6]/6 +0 ", ended.out)
    assert pd.read_parquet(scores / "scores.parquet")["geodesic_deg"].max() < 2.0
    ended = hardlight("report", scores)
    assert ended.status == 0
    assert (scores / "report.html").stat().st_size > 20_000
    assert str((scores / "report.html").resolve()) in ended.out


MINE = """
from estimators.api import Estimate, Outcome

class Mine:
    def start(self, knowledge): ...
    def step(self, observation):
        return Estimate("nav", Outcome.NO_FEATURES, reason=f"nothing in\\n{observation.frame}")

class Unlicensed(Mine):
    def start(self, knowledge):
        raise SystemExit("no licence")
"""


@pytest.mark.parametrize(
    ("name", "status", "said"),
    [
        ("Mine", 0, "6 no_features\n  nothing in 0\n  nothing in 1\n  nothing in 2\n  and 3 more reasons, see extras.parquet\n"),
        ("Unlicensed", 1, "6 crashed\n  start: SystemExit: no licence\n"),
    ],
)
def test_a_method_beside_me_needs_no_installation_and_failing_everywhere_says_why(
    tiny_dataset: Path, tmp_path: Path, name: str, status: int, said: str
) -> None:
    (tmp_path / "mymod.py").write_text(MINE)
    script = Path(sys.executable).with_name("hardlight")  # the console script: it alone lacks the working directory
    command = [script, "estimate", f"mymod:{name}", tiny_dataset, "--feature", "wing", "--out", "answers", "--quiet"]
    done = subprocess.run(command, check=False, capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (status, f"answers: {said}", "")


def test_the_same_estimate_twice_gives_the_same_answers(tiny_dataset: Path, tmp_path: Path, hardlight: Callable[..., Any]) -> None:
    tables = []
    for _ in range(2):
        hardlight("estimate", "mono-rectangle", tiny_dataset, "--feature", "wing", "--out", tmp_path / "a", "--quiet")
        tables.append(pd.read_csv(tmp_path / "a" / "predictions.csv").drop(columns=["cpu_s", "wall_s"]))
    pd.testing.assert_frame_equal(*tables, check_exact=True)


def test_answers_written_by_another_program_are_judged(tiny_dataset: Path, tmp_path: Path, hardlight: Callable[..., Any]) -> None:
    """The second door: four keys in run.json and a CSV, by hand."""
    truth = pd.read_parquet(tiny_dataset / "truth.parquet")
    lines = ["frame,sensor,outcome,qw,qx,qy,qz,tx_m,ty_m,tz_m,cpu_s,wall_s"]
    for row in truth.itertuples():
        lines.append(f"{row.frame},nav,ok,{-row.qw:.6f},{-row.qx:.6f},{-row.qy:.6f},{-row.qz:.6f},,,,,")
    (tmp_path / "predictions.csv").write_text("\n".join(lines[:-1]) + "\n")
    identity = json.loads((tiny_dataset / "manifest.json").read_text())["identity"]
    record = {"format": "hardlight-predictions", "version": 1, "method": "by hand", "dataset_identity": identity}
    (tmp_path / "run.json").write_text(json.dumps(record))
    ended = hardlight("judge", tmp_path, tiny_dataset, "--out", tmp_path / "scores")
    assert ended.status == 0
    (summary,) = json.loads((tmp_path / "scores" / "summary.json").read_text())
    assert summary["outcomes"] == {"ok": 5, "skipped": 1}
    assert summary["geodesic_p95_deg"]["value"] < 2e-4
    assert hardlight("report", tmp_path / "scores").status == 0


def test_bench_renders_judges_and_reports_and_reuses_its_data_set(
    tiny_scenario: Path, tmp_path: Path, hardlight: Callable[..., Any]
) -> None:
    (tmp_path / "tiny.toml").write_text(tiny_scenario.read_text())
    (tmp_path / "suite.toml").write_text(SUITE)
    out = tmp_path / "out"
    ended = hardlight("bench", tmp_path / "suite.toml", "--out", out)
    assert ended.status == 0
    assert re.search(r"slice +wing +filtered +\d/3", ended.out)
    page = (out / "report.html").read_text()
    assert page.partition('id="explore"')[0].count('class="plot"') == 2
    stamps = {path: path.stat().st_mtime_ns for path in (out / "datasets").rglob("*.png")}
    assert [path.parent.name for path in sorted(stamps)] == ["000001", "000003", "000005"]
    started = time.perf_counter()
    assert hardlight("bench", tmp_path / "suite.toml", "--out", out, "--quiet").status == 0
    assert {path: path.stat().st_mtime_ns for path in (out / "datasets").rglob("*.png")} == stamps
    assert time.perf_counter() - started < 60


def test_an_estimator_of_ones_own_comes_through_the_class_door(
    tiny_dataset: Path, tmp_path: Path, hardlight: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "stranger.py").write_text(
        "from estimators.api import Estimate, Outcome\n"
        "class Shy:\n"
        "    def __init__(self, excuse='no reason'): self.excuse = excuse\n"
        "    def start(self, knowledge): self.sensor = next(iter(knowledge.sensors))\n"
        "    def step(self, observation): return Estimate(self.sensor, Outcome.SKIPPED, reason=self.excuse)\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    answers = tmp_path / "a"
    ended = hardlight("estimate", "stranger:Shy", tiny_dataset, "--feature", "wing", "--set", "excuse=busy", "--out", answers)
    assert (ended.status, ended.out) == (0, f"{answers}: 6 skipped\n  busy\n")
    assert set(pd.read_parquet(answers / "extras.parquet")["reason"]) == {"busy"}
    assert "stranger:Shy" not in registry.names()


def test_a_log_has_a_line_a_stage_and_quiet_has_none(tiny_dataset: Path, tmp_path: Path, hardlight: Callable[..., Any]) -> None:
    arguments = ("estimate", "mono-rectangle", tiny_dataset, "--feature", "span", "--out", tmp_path / "a")
    assert hardlight(*arguments).err == "done: mono-rectangle: 6 frames\n"
    assert hardlight(*arguments, "--quiet").err == ""


def test_ctrl_c_leaves_a_data_set_that_resume_finishes(tiny_scenario: Path, tmp_path: Path, hardlight: Callable[..., Any]) -> None:
    out = tmp_path / "data"
    render = _command("render", tiny_scenario, "--out", out, "--set", "frame_count=30", "--quiet")
    process = subprocess.Popen(render, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 120
    while not list(out.glob("frames/0*")) and time.monotonic() < deadline:
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in said
    assert "the same command with --resume goes on" in said
    assert 0 < len(list(out.glob("frames/0*"))) < 30
    assert not (out / "truth.parquet").exists()
    again = hardlight("render", tiny_scenario, "--out", out, "--set", "frame_count=30", "--resume", "--quiet")
    assert (again.status, again.out) == (0, f"{out}: 30 frames\n")
    assert hardlight("verify", out, "--sample", 0).status == 0


def test_ctrl_c_within_a_recorded_kernel_counts_too(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """Dr.Jit raises a RuntimeError from it."""
    from benchmark import cli, verbs

    def wrapped(*_: object) -> None:
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as error:
            raise RuntimeError("record(): error encountered while recording a frozen function") from error

    monkeypatch.setattr(verbs, "render", wrapped)
    with pytest.raises(SystemExit) as ended:
        cli.main(["render", "zhai2014-in-plane", "--out", "nowhere"])
    assert ended.value.code == 130
    assert "the same command with --resume goes on" in capsys.readouterr().err


def test_debug_shows_the_traceback_and_its_absence_does_not(tmp_path: Path, hardlight: Callable[..., Any]) -> None:
    plain, full = hardlight("report", tmp_path), hardlight("report", tmp_path, "--debug")
    assert plain.status == full.status == 1
    assert "Traceback" not in plain.err
    assert plain.err.count("\n") == 1
    assert "Traceback" in full.err


def test_our_own_mistake_is_one_sentence_too(
    tiny_dataset: Path, tmp_path: Path, hardlight: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise KeyError("oops")

    monkeypatch.setattr("benchmark.verbs.judge", broken)
    ended = hardlight("judge", tmp_path, tiny_dataset, "--out", tmp_path / "s")
    assert ended.status == 1
    assert ended.err.startswith("hardlight judge: internal error (KeyError: 'oops'); please report it")
    assert ended.err.count("\n") == 1


@pytest.mark.parametrize("arguments", [(), ("--nonsense",), ("rendr",)])
def test_wrong_usage_ends_with_2(arguments: tuple[str, ...], hardlight: Callable[..., Any]) -> None:
    assert hardlight(*arguments).status == 2


def test_a_terminal_gets_a_bar_with_the_time_that_is_left(tiny_dataset: Path, tmp_path: Path) -> None:
    reader, writer = os.openpty()
    command = _command("estimate", "mono-rectangle", tiny_dataset, "--feature", "span", "--out", tmp_path / "a")
    process = subprocess.Popen(command, stderr=writer, stdout=subprocess.DEVNULL, env=os.environ | {"TERM": "xterm"})
    os.close(writer)
    said = b""
    while True:
        try:
            piece = os.read(reader, 65536)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        said += piece
    assert process.wait() == 0
    os.close(reader)
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", said.decode())
    assert re.search(r"mono-rectangle: 6 frames .*6/6 +0:00:0\d +left +0:00:00", text), text


def test_verify_does_not_repeat_what_this_machine_would_render_otherwise(
    tiny_dataset: Path, tmp_path: Path, hardlight: Callable[..., Any]
) -> None:
    """Manifests of another version are rewritten with a right identity, so that only the versions differ."""
    copy = tmp_path / "data"
    shutil.copytree(tiny_dataset, copy)
    manifest = read_manifest(copy)
    older = manifest.model_copy(update={"software": manifest.software | {"mitsuba": "3.0.0"}})
    (copy / "manifest.json").write_text(older.to_json())
    ended = hardlight("verify", copy, "--quiet")
    assert ended.status == 0
    assert re.search(r"no frame was rendered again, .*software\.mitsuba: 3\.0\.0 in the folder", ended.out)
    stranger = manifest.model_copy(update={"scenario": manifest.scenario | {"frame_count": "many"}})
    (copy / "manifest.json").write_text(stranger.to_json())
    ended = hardlight("verify", copy, "--quiet")
    assert ended.status == 0
    assert "its scenario is not one that this version can read" in ended.out
