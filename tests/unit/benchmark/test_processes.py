"""A pool of processes: every job comes back with its outcome, the first error ends the rest, Ctrl-C is the parent's alone."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from benchmark.processes import done_in_processes
from scenes.errors import HardlightError

INTERRUPTED = """
import time
from benchmark.processes import done_in_processes

time.sleep(0.5 if __name__ != "__main__" else 0.0)  # a worker that imports something large


def start() -> None:
    pass


def work(job: int) -> int:
    time.sleep(0.2)
    return job


if __name__ == "__main__":
    print("go", flush=True)
    try:
        print(len(list(done_in_processes(work, range(50), 2, start))))
    except KeyboardInterrupt:
        print("interrupted", flush=True)
"""


def nothing() -> None:
    """Readies a process that needs nothing."""


def doubled(job: int) -> int:
    if job < 0:
        raise ValueError(f"no {job}")
    return 2 * job


def ended(job: int) -> int:
    os._exit(job)


def test_every_job_comes_back_with_its_outcome() -> None:
    assert sorted(done_in_processes(doubled, range(5), 2, nothing)) == [(one, 2 * one) for one in range(5)]


def test_an_error_is_raised_here_and_a_process_that_dies_is_said() -> None:
    with pytest.raises(ValueError, match="no -1"):
        list(done_in_processes(doubled, [1, -1], 1, nothing))
    with pytest.raises(HardlightError, match="a worker process died"):
        list(done_in_processes(ended, [3], 1, nothing))


def test_an_interrupt_while_processes_start_is_the_parents_alone(tmp_path: Path) -> None:
    script = tmp_path / "interrupted.py"
    script.write_text(INTERRUPTED, encoding="utf-8")
    command, pipe = [sys.executable, str(script)], subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=True) as run:
        assert run.stdout is not None
        assert run.stdout.readline() == "go\n"
        time.sleep(0.4)
        os.killpg(run.pid, signal.SIGINT)
        out, said = run.communicate(timeout=60)
    assert (out, said, run.returncode) == ("interrupted\n", "", 0)
