"""A method in a process of its own answers what it answers here, and whatever it does to its process is an outcome."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from benchmark.knowledge import declare
from benchmark.limits import Limits
from benchmark.predictions import Predictions
from benchmark.run import LOG, could_not_start, estimate
from scenes.dataset import Dataset
from scenes.errors import UsageError

BRIEF = Limits(step_timeout_s=3.0, start_timeout_s=60.0)


@pytest.fixture(scope="module")
def short(make_dataset: Callable[..., Dataset], tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    return make_dataset(tmp_path_factory.mktemp("data") / "short", frames=range(4))


@pytest.fixture(autouse=True)
def _misbehaving_is_found(monkeypatch: pytest.MonkeyPatch, repository: Path) -> None:
    monkeypatch.syspath_prepend(repository / "tests" / "system")


def _run(dataset: Dataset, method: str, out: Path, limits: Limits | None = BRIEF, **parameters: Any) -> Predictions:
    return estimate(method, parameters, dataset, declare(dataset, "panel", sigma_px=1.0), out, limits=limits)


def _outcomes(answers: Predictions) -> list[str]:
    return answers.table["outcome"].tolist()


def _reason(answers: Predictions, frame: int) -> str:
    assert answers.extras is not None
    return str(answers.extras.set_index("frame")["reason"][frame])


@pytest.mark.parametrize("method", ["mono-rectangle", "mono-rectangle-paper"])
def test_answers_are_those_of_this_process_to_the_last_bit(method: str, dataset: Dataset, tmp_path: Path) -> None:
    apart, here = _run(dataset, method, tmp_path / "a", Limits()), _run(dataset, method, tmp_path / "b", None)
    assert "ok" in _outcomes(here)
    times = ["cpu_s", "wall_s"]
    pd.testing.assert_frame_equal(apart.table.drop(columns=times), here.table.drop(columns=times), check_exact=True)
    pd.testing.assert_frame_equal(apart.extras, here.extras, check_exact=True)
    assert (apart.table["cpu_s"] > 0).all()
    assert apart.record.start_wall_s is not None
    assert {path.name for path in (tmp_path / "a").iterdir()} == {path.name for path in (tmp_path / "b").iterdir()}


@pytest.mark.parametrize(
    ("name", "outcome", "reason"),
    [
        ("Segfaults", "crashed", "its process was killed by signal 11 (Segmentation fault)"),
        ("Interrupts", "crashed", "KeyboardInterrupt: "),
        ("Alien", "crashed", "step returned function, not an Estimate"),
        ("Breeds", "crashed", "its process ended with status 0"),
        ("Meddles", "crashed", "its process sent something that is no answer"),
        ("ClosesOutputs", "ok", ""),
        ("ClosesEverything", "crashed", "its process ended with status 1"),
        ("Floods", "ok", ""),
    ],
)
def test_one_bad_frame_does_not_spoil_the_others(name: str, outcome: str, reason: str, short: Dataset, tmp_path: Path) -> None:
    answers = _run(short, f"misbehaving:{name}", tmp_path)
    assert _outcomes(answers) == ["ok", outcome, "ok", "ok"]
    assert _reason(answers, 1) == reason


def test_a_hang_in_start_is_a_time_out_of_every_frame(short: Dataset, tmp_path: Path) -> None:
    began = time.perf_counter()
    answers = _run(short, "misbehaving:HangsInStart", tmp_path, Limits(start_timeout_s=4.0))
    assert time.perf_counter() - began < 12.0
    assert _outcomes(answers) == ["timed_out"] * 4
    assert could_not_start(answers)
    assert _reason(answers, 3) == "start: no answer within 4 s"
    assert answers.table["wall_s"].max() == 0.0
    assert answers.record.start_wall_s is not None
    assert answers.record.start_wall_s >= 4.0


ALWAYS = """
import os
from estimators.api import Estimate, Outcome

class Exits:
    def start(self, knowledge): ...
    def step(self, observation): os._exit(7)

class BrokenModule: ...

class Crowded(Exits):
    def step(self, observation):
        print(f"frame {observation.frame} in {os.getpid()}")
        hoard = bytearray(400 << 20)
        hoard[::4096] = b"x" * len(hoard[::4096])
        children = [os.fork() for _ in range(2)]
        if 0 in children:
            os._exit(0)
        for child in children:
            os.waitpid(child, 0)
        return Estimate("nav", Outcome.SKIPPED, reason="busy")
"""


@pytest.fixture
def _always(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "always.py").write_text(ALWAYS)
    monkeypatch.syspath_prepend(tmp_path)


@pytest.mark.usefixtures("_always")
def test_after_so_many_restarts_the_rest_is_not_asked(short: Dataset, tmp_path: Path) -> None:
    answers = _run(short, "always:Exits", tmp_path / "a", Limits(restarts=1))
    assert _outcomes(answers) == ["crashed"] * 4
    died = "its process ended with status 7"
    gave_up = f"not asked, since its 1 restarts are used up; at last {died}"
    assert [_reason(answers, frame) for frame in range(4)] == [died, died, gave_up, gave_up]


@pytest.mark.usefixtures("_always")
def test_memory_that_forked_processes_share_counts_once(short: Dataset, tmp_path: Path) -> None:
    answers = _run(short, "always:Crowded", tmp_path / "a", Limits(memory_gib=1.0))
    assert _outcomes(answers) == ["skipped"] * 4
    log = (tmp_path / "a" / LOG).read_text()
    assert [line.split(" in ")[0] for line in log.splitlines()] == [f"frame {frame}" for frame in range(4)]
    assert len({line.split(" in ")[1] for line in log.splitlines()}) == 1


@pytest.mark.usefixtures("_always")
def test_what_cannot_be_loaded_is_wrong_usage_or_where_asked_for_a_crash(short: Dataset, tmp_path: Path) -> None:
    out = tmp_path / "a"
    with pytest.raises(UsageError, match="module 'always' has no 'Nobody'"):
        _run(short, "always:Nobody", out)
    assert not out.exists()
    declaration = declare(short, "panel")
    answers = estimate("always:Nobody", {}, short, declaration, out, forgiving=True)
    assert _outcomes(answers) == ["crashed"] * 4
    assert _reason(answers, 2) == "start: method 'always:Nobody': module 'always' has no 'Nobody'"
    with pytest.raises(UsageError, match="method 'mono-rectangle' refuses nonsense: no such key"):
        _run(short, "mono-rectangle", tmp_path / "b", nonsense=1)
    with pytest.raises(UsageError, match="parameters cannot go to another process"):
        _run(short, "mono-rectangle", tmp_path / "b", nonsense=lambda: None)


def test_the_traceback_is_in_the_log_and_an_old_log_goes(short: Dataset, tmp_path: Path) -> None:
    _run(short, "misbehaving:Raises", tmp_path / "a")
    log = (tmp_path / "a" / LOG).read_text()
    assert "Traceback" in log
    assert 'raise ZeroDivisionError("division by zero")' in log
    (tmp_path / "b").mkdir()
    _run(short, "misbehaving:Identity", tmp_path / "b")
    (tmp_path / "b" / LOG).write_text("old")
    _run(short, "misbehaving:Identity", tmp_path / "b")
    assert not (tmp_path / "b" / LOG).exists()


def _descendants(pid: int) -> set[int]:
    found = {int(one) for one in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()}
    return found | {two for one in found for two in _descendants(one)}


KILLED = """
import sys, time
from pathlib import Path
from benchmark.isolation.session import Isolated
from benchmark.limits import Limits
from benchmark.knowledge import declare
from scenes.dataset import Dataset
dataset = Dataset.open(Path(sys.argv[1]))
with Isolated("misbehaving:Hangs", {}, Limits(), ()) as one:
    one.start(declare(dataset, "panel").knowledge)
    print("ready", flush=True)
    one.step(dataset.observation(1))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells a process of its parent's death")
def test_nothing_outlives_a_judge_that_is_killed(short: Dataset, repository: Path, tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONPATH": str(repository / "tests" / "system"), "TMPDIR": str(tmp_path)}
    command = [sys.executable, "-c", KILLED, str(short.path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment, text=True) as judge:
        assert judge.stdout is not None
        assert judge.stdout.readline() == "ready\n"
        (method,) = _descendants(judge.pid)
        judge.send_signal(signal.SIGKILL)
    deadline = time.monotonic() + 10
    while Path(f"/proc/{method}").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not Path(f"/proc/{method}").exists()


def test_ctrl_c_ends_the_method_too(short: Dataset, repository: Path) -> None:
    environment = os.environ | {"PYTHONPATH": str(repository / "tests" / "system")}
    command = [sys.executable, "-c", KILLED, str(short.path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment, text=True) as judge:
        assert judge.stdout is not None
        assert judge.stdout.readline() == "ready\n"
        (method,) = _descendants(judge.pid)
        judge.send_signal(signal.SIGINT)
        _, said = judge.communicate(timeout=20)
    assert said.splitlines()[-1] == "KeyboardInterrupt"
    assert not Path(f"/proc/{method}").exists()


def test_the_time_of_threads_and_children_counts(short: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "busy.py").write_text(
        "import os, time\n"
        "from estimators.api import Estimate, Outcome\n"
        "class Busy:\n"
        "    def start(self, knowledge): ...\n"
        "    def step(self, observation):\n"
        "        child = os.fork()\n"
        "        until = time.process_time() + 0.2\n"
        "        while time.process_time() < until: pass\n"
        "        if child == 0: os._exit(0)\n"
        "        os.waitpid(child, 0)\n"
        "        return Estimate('nav', Outcome.SKIPPED, reason='busy')\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    table = _run(short, "busy:Busy", tmp_path / "a", Limits()).table
    assert np.all(table["cpu_s"] >= 0.4)
    assert np.all(table["cpu_s"] < 0.6)


KEEPING = """
import numpy as np
from estimators.api import Estimate, Outcome

class Keeping:
    def __init__(self, count): self.count = count
    def start(self, knowledge): self.kept, self.knowledge = [], knowledge
    def step(self, observation):
        pixels = observation.images["nav"].pixels
        self.kept = [*self.kept, (pixels, pixels.copy())][-self.count:]
        same = all(np.array_equal(one, copy) for one, copy in self.kept)
        return Estimate("nav", Outcome.SKIPPED, reason="busy", extras={"same": same, "kept": len(self.kept)})
"""


@pytest.mark.parametrize("count", [1, 2, 3, 21])
def test_a_frame_that_is_kept_stays_as_it_was(
    count: int, dataset: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However many a method keeps: the memory through which frames come is used again, those that are kept are not."""
    (tmp_path / "keeping.py").write_text(KEEPING)
    monkeypatch.syspath_prepend(tmp_path)
    extras = _run(dataset, "keeping:Keeping", tmp_path / "a", Limits(), count=count).extras
    assert extras is not None
    assert (extras["same"] == 1.0).all()
    assert extras["kept"].iloc[-1] == count
