"""A study's points, each rendered, answered, judged and bounded by one process: the loop over points."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmark import bench, results
from benchmark.case import Case, CaseRun
from benchmark.entries import answer_and_judge
from benchmark.files import publish
from benchmark.progress import Progress
from benchmark.results import Results
from benchmark.run_bounds import forget
from benchmark.study import record
from benchmark.study.points import Point, points, table
from benchmark.study.spec import Study, case_of, suite_of
from benchmark.suite import Suite
from renderer.processes import done_in_processes
from scenes.errors import UsageError


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """One data set of one point, and all that is done with it."""

    suite: Suite
    case: Case
    run: CaseRun
    out: Path


def study(study: Study, out: Path, *, workers: int = 1, progress: Progress | None = None, command: str = "") -> Results:
    """Runs every point of ``study`` into ``out``, keeping what lies there and would come out the same; returns the index.

    A point that cannot be rendered or asked about is left out and named in study.json; the others are not touched by it.
    """
    chosen = points(study)
    index, refused = _points_done(study, chosen, out, workers=workers, progress=progress, command=command)
    if all(point.name in refused for point in chosen):  # before anything is written: what lies there may be another try's
        raise UsageError(f"no point could be done; the first: {next(iter(refused.values()))}")
    results.write(out, index)
    if study.bound_frames is None:
        forget(out, (one.name for one in index.cases))
    kept = tuple(point for point in chosen if study.design == "sobol" or point.name not in refused)  # SALib counts rows
    publish(out, {record.POINTS: table(study, kept).to_parquet(index=False)})
    record.write(out, record.record_of(study, command, refused))
    return index


def run_points(
    study: Study, chosen: Sequence[Point], out: Path, *, workers: int = 1, progress: Progress | None = None, command: str = ""
) -> tuple[Results, dict[str, str]]:
    """Does the work of ``chosen`` and writes results.json. Also returned: point → why it could not be done."""
    index, refused = _points_done(study, chosen, out, workers=workers, progress=progress, command=command)
    results.write(out, index)
    return index, refused


def _points_done(
    study: Study, chosen: Sequence[Point], out: Path, *, workers: int, progress: Progress | None, command: str
) -> tuple[Results, dict[str, str]]:
    unique = {point.name: point for point in chosen}
    cases = tuple(case_of(study, name, point.label, point.scenario) for name, point in unique.items())
    suite = suite_of(study, cases)
    bench.refuse_unknown_methods(suite)
    alone = {case.name: suite.model_copy(update={"cases": (case,)}) for case in cases}
    jobs = [Job(alone[case.name], case, run, out) for case in cases for run in case.runs]
    refused: dict[str, str] = {}
    for done, (job, fault) in enumerate(_done(jobs, workers), start=1):
        if fault is not None:
            refused.setdefault(job.case.name, fault)
        if progress is not None:
            progress(done, len(jobs))
    return _index([job for job in jobs if job.case.name not in refused], suite, out, command), refused


def do(job: Job) -> str | None:
    """Renders what is missing of a data set, bounds it, lets every method answer, judges. What stands in the way of it, if so.

    Not every setting is a scenario: a lamp stands inside of the target, or what is asked for lies outside of the picture.
    """
    path = job.out / bench.DATASETS / job.run.name
    try:
        bench.render_run(job.suite, job.case, job.run, path, 1, None, bench.silent)
        bench.bound_run(job.suite, job.case, job.run, path, job.out, bench.silent)
        for task in bench.tasks_of(job.suite, job.case, job.run, path, job.out, job.suite.limits):
            answer_and_judge(task)
    except UsageError as error:
        return str(error)
    return None


def _index(jobs: Sequence[Job], suite: Suite, out: Path, command: str) -> Results:
    tasks = [
        task
        for job in jobs
        for task in bench.tasks_of(job.suite, job.case, job.run, out / bench.DATASETS / job.run.name, out, job.suite.limits)
    ]
    return Results(
        title=suite.title,
        description=suite.description,
        command=command,
        cases=tuple(bench.heading_of(job.case, job.run) for job in jobs),
        entries=tuple(bench.entry_of(task, out) for task in tasks),
        notes=suite.notes,
    )


def _done(jobs: Sequence[Job], workers: int) -> Iterator[tuple[Job, str | None]]:
    """Every job with its fault, as they end."""
    if workers == 1:
        for job in jobs:
            yield job, do(job)
        return
    threads = max(1, (os.cpu_count() or 1) // workers)
    yield from done_in_processes(do, jobs, workers, _start_worker, (threads,))


def _start_worker(threads: int) -> None:
    from renderer import worker

    worker.start(threads)
