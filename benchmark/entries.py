"""One entry of a leaderboard: a method answers a data set and is judged. Several may be made at once, a process each."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from benchmark.case import CaseRun
from benchmark.limits import Limits
from benchmark.progress import Progress
from benchmark.suite import Method
from renderer import processes
from scenes.dataset import Dataset

Stages = Callable[[str], AbstractContextManager[Progress | None]]


@dataclass(frozen=True, slots=True)
class Task:
    """What makes one entry. ``feature`` or ``lidar`` says what is asked for; ``folder`` takes answers and scores.

    The method runs in a process of its own within ``limits``; where these are None, in the one that makes the entry. With
    ``reuse`` answers are kept that are there already and would come out the same. ``bounds``: a file of the data set's bounds.
    """

    run: CaseRun
    dataset: Path
    feature: str | None
    rig: str | None
    lidar: str | None
    title: str
    method: Method
    sigma_px: float
    settle_s: float
    folder: Path
    limits: Limits | None
    reuse: bool = True
    bounds: Path | None = None

    @property
    def name(self) -> str:
        """The entry as a person reads it."""
        return f"{self.title} on {self.run.name}" + ("" if self.feature is None else f", {self.feature}")


def done_here(tasks: Sequence[Task], stages: Stages) -> None:
    """Makes the entries one after the other, each with a progress of its own."""
    for task in tasks:
        with stages(task.name) as progress:
            answer_and_judge(task, progress)


def done_in_processes(tasks: Sequence[Task], workers: int, stages: Stages) -> None:
    """Makes the entries in processes of their own. The first fault ends the rest.

    CPU seconds are each process's own, so a table of them means the same as with one process; wall seconds do not.
    """
    with stages(f"{len(tasks)} entries, {workers} at a time") as progress:
        for done, _ in enumerate(processes.done_in_processes(answer_and_judge, tasks, workers), start=1):
            if progress is not None:
                progress(done, len(tasks))


def answer_and_judge(task: Task, progress: Progress | None = None) -> None:
    """Declares, lets the method answer and judges it; all that is left behind lies in the task's folder."""
    import pandas as pd

    from benchmark import freshness, judge, run
    from benchmark.knowledge import declare

    dataset, method = Dataset.open(task.dataset), task.method
    declaration = declare(
        dataset,
        task.feature,
        task.sigma_px,
        grant_aspect=method.aspect,
        grant_radius=method.radius,
        rig=task.rig,
        lidar=task.lidar,
        grant_model=method.model,
    )
    given = run.estimate(
        method.estimator,
        method.parameters,
        dataset,
        declaration,
        task.folder,
        label=task.title,
        progress=progress,
        limits=task.limits,
        forgiving=True,
        reuse=task.reuse,
    )
    if not (task.reuse and freshness.is_judged(task.folder, dataset, task.settle_s, task.bounds)):
        bounds = None if task.bounds is None else pd.read_parquet(task.bounds)
        judge.write(task.folder, judge.judge(given, dataset, task.settle_s, bounds))
        freshness.mark_judged(task.folder, dataset, task.settle_s, task.bounds)
