"""What a process of its own costs a method. Run: python tests/speed/isolation.py [suite [folder with its data sets]]

For every method, feature and data set of the suite (default: demo): the CPU time of the judge's process while it asks, without
reading the data set, and of the method's process around its steps, over the method's own. Starting the process is apart. In the
method's process the one thread is measured that serves: libraries keep threads of their own turning after a step has ended.

Where Python may not keep compiled modules (PYTHONDONTWRITEBYTECODE) every start compiles those of NumPy, SciPy and pydantic anew,
which is more than half of its CPU time. So they are kept here, in a folder that goes when the measurement ends.
"""

import json
import os
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from benchmark.bench import bench
from benchmark.isolation import process
from benchmark.isolation.session import Isolated
from benchmark.knowledge import Declaration, declare
from benchmark.limits import Limits
from benchmark.results import read
from benchmark.suite import Method, load_suite
from scenes.dataset import Dataset

TIMED = """
import json, os, sys, time
sys.path[:] = json.loads(os.environ.pop('HARDLIGHT_WORKER_SEARCH_PATH'))
from benchmark import guarded
from benchmark.isolation import worker
receive, step, asked, stepped = worker.receive, guarded.Guarded.step, [], []
def noted(channel):
    asked.append((time.thread_time(), time.process_time()))
    return receive(channel)
def timed(self, observation):
    before = time.thread_time()
    answer = step(self, observation)
    stepped.append(time.thread_time() - before)
    return answer
worker.receive, guarded.Guarded.step = noted, timed
worker.main()
print(json.dumps([asked[1][1], time.thread_time() - asked[1][0] - sum(stepped)]))
"""
LIMIT = 0.03  # of the methods' CPU time over the suite
START_LIMIT_S = 1.0  # wall, for the interpreter and its imports


@dataclass
class Cost:
    """Seconds. ``judge`` and ``worker``: CPU beside the method's own ``steps``; ``start_*``: the same until it is ready."""

    steps: float = 0.0
    judge: float = 0.0
    worker: float = 0.0
    start_judge: float = 0.0
    start_worker: float = 0.0
    start_wall: float = 0.0
    frames: int = 0

    def add(self, other: "Cost") -> None:
        for name in vars(self):
            setattr(self, name, getattr(self, name) + getattr(other, name))


def measured(method: Method, dataset: Dataset, told: Declaration) -> Cost:
    """One sequence; the observations are in memory before the clock runs."""
    observations = [dataset.observation(frame) for frame in dataset.frames]
    cost, began, wall = Cost(frames=len(observations)), time.process_time(), time.perf_counter()
    with Isolated(method.estimator, method.parameters, Limits(), (dataset.path,)) as isolated:
        opening = isolated.start(told.knowledge)
        cost.start_judge, cost.start_wall = time.process_time() - began, time.perf_counter() - wall - opening.wall_s
        began = time.process_time()
        for observation in observations:
            cost.steps += isolated.step(observation).cpu_s
        cost.judge = time.process_time() - began
    cost.start_worker, cost.worker = json.loads(isolated.log.splitlines()[-1])
    return cost


def line(name: str, cost: Cost) -> str:
    share, ms = (cost.judge + cost.worker) / cost.steps, 1e3 / cost.frames
    return (
        f"{name:60s} {cost.steps * ms:8.2f} {cost.judge * ms:7.3f} {cost.worker * ms:7.3f} ms a frame {share:7.2%}"
        f"   start {cost.start_wall:5.2f} s wall, {cost.start_worker:5.2f} + {cost.start_judge:5.3f} s CPU"
    )


def _keep_compiled(folder: Path) -> None:
    """As a user's second run finds them."""
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    os.environ["PYTHONPYCACHEPREFIX"] = str(folder)


def main() -> None:
    """A line an entry, then the sum."""
    process.PROGRAM = TIMED
    suite = load_suite(sys.argv[1] if len(sys.argv) > 1 else "demo")
    with tempfile.TemporaryDirectory() as made:
        _keep_compiled(Path(made) / "compiled")
        folder = Path(sys.argv[2]) if len(sys.argv) > 2 else Path(made) / "demo"
        if not (folder / "results.json").exists():
            bench(suite, folder)
        total, count = Cost(), 0
        print(f"{'':60s}   method   judge  worker")
        for entry in read(folder).entries:
            dataset, method = Dataset.open(folder / entry.dataset), suite.methods[entry.title]
            granted = {"grant_aspect": method.aspect, "grant_radius": method.radius, "grant_model": method.model}
            told = declare(dataset, entry.feature, suite.prior_sigma_px, **granted)
            cost = measured(method, dataset, told)
            print(line(f"{entry.title} on {entry.case}, {entry.feature}", cost), flush=True)
            total.add(cost)
            count += 1
    print(line("all", total).partition("   start")[0], f"(limit {LIMIT:.0%})")
    ready_s, cpu_s = total.start_wall / count, total.start_worker / count
    print(f"a process is ready after {ready_s:.2f} s of wall time (limit {START_LIMIT_S:.0f} s), {cpu_s:.2f} s of CPU")


if __name__ == "__main__":
    main()
