"""A pool of processes: every job comes back with its outcome, the first error ends the rest, and all end with their parent."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from renderer.processes import done_in_processes
from scenes.errors import HardlightError

PROGRAM = """
import os, time
from pathlib import Path
from renderer.processes import done_in_processes

time.sleep(0.5 if __name__ != "__main__" else 0.0)  # a worker that imports something large


def work(job: int) -> int:
    Path(f"worker-{os.getpid()}").touch()
    time.sleep(0.2)
    return job


if __name__ == "__main__":
    print("go", flush=True)
    try:
        print(len(list(done_in_processes(work, range(50), 2))))
    except KeyboardInterrupt:
        print("interrupted", flush=True)
"""


def doubled(job: int) -> int:
    if job < 0:
        raise ValueError(f"no {job}")
    return 2 * job


def ended(job: int) -> int:
    os._exit(job)


def test_every_job_comes_back_with_its_outcome() -> None:
    assert sorted(done_in_processes(doubled, range(5), 2)) == [(one, 2 * one) for one in range(5)]


def test_an_error_is_raised_here_and_a_process_that_dies_is_said() -> None:
    with pytest.raises(ValueError, match="no -1"):
        list(done_in_processes(doubled, [1, -1], 1))
    with pytest.raises(HardlightError, match="a worker process died"):
        list(done_in_processes(ended, [3], 1))


@pytest.fixture
def begun(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """A program that is about to start two processes with ten seconds of work."""
    script = tmp_path / "program.py"
    script.write_text(PROGRAM, encoding="utf-8")
    command, pipe = [sys.executable, str(script)], subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=True, cwd=tmp_path) as run:
        assert run.stdout is not None
        assert run.stdout.readline() == "go\n"
        yield run


def test_an_interrupt_while_processes_start_is_the_parents_alone(begun: subprocess.Popen[str]) -> None:
    time.sleep(0.4)
    os.killpg(begun.pid, signal.SIGINT)
    out, said = begun.communicate(timeout=60)
    assert (out, said, begun.returncode) == ("interrupted\n", "", 0)


def test_processes_end_when_their_parent_is_killed(begun: subprocess.Popen[str], tmp_path: Path) -> None:
    _wait_until(lambda: len(list(tmp_path.glob("worker-*"))) == 2)
    begun.kill()
    workers = [Path("/proc") / path.name.removeprefix("worker-") for path in tmp_path.glob("worker-*")]
    _wait_until(lambda: not any(worker.exists() for worker in workers))


def _wait_until(is_so: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 30
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.02)
