"""The leaderboard: render or reuse each case's data sets, let every method answer, judge, index. Tables and pages come after."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

from benchmark import results, run_bounds
from benchmark.case import Case, CaseRun
from benchmark.entries import Task, done_here, done_in_processes
from benchmark.limits import Limits
from benchmark.progress import Progress
from benchmark.results import CaseHeading, Entry, Results
from benchmark.suite import Suite
from estimators import registry
from scenes.dataset import Dataset
from scenes.errors import DatasetConflict, UsageError, unknown
from scenes.scenario import Quality

Stages = Callable[[str], AbstractContextManager[Progress | None]]
DATASETS, ENTRIES = "datasets", "entries"


def silent(_: str) -> AbstractContextManager[Progress | None]:
    """The stages of a run that says nothing of its progress."""
    return nullcontext(None)


def bench(
    suite: Suite,
    out: Path,
    *,
    workers: int = 1,
    quality: Quality | None = None,
    stages: Stages = silent,
    in_process: bool = False,
    command: str = "",
) -> Results:
    """Runs ``suite`` into ``out`` and returns its index, which is also written there as results.json.

    ``stages`` opens the progress of one stage by its title. Data sets already in ``out`` are reused where their digest
    fits, else refused; answers and scores are kept that would come out the same. ``workers`` processes render, then
    answer, an entry each.
    Every method runs in a process of its own, within the suite's limits; ``in_process`` runs them here, to be debugged. One that
    crashes, hangs or cannot be loaded has failed in the frames concerned. Raises ``UsageError`` for a method that nobody knows.
    """
    refuse_unknown_methods(suite)
    runs = [(case, run) for case in suite.cases for run in case.runs]
    tasks: list[Task] = []
    for case, run in runs:
        path = out / DATASETS / run.name
        render_run(suite, case, run, path, workers, quality, stages)
        bound_run(suite, case, run, path, out, stages)
        tasks += tasks_of(suite, case, run, path, out, None if in_process else case.limits or suite.limits)
    if workers == 1:
        done_here(tasks, stages)
    else:
        done_in_processes(tasks, workers, stages)
    index = Results(
        title=suite.title,
        description=suite.description,
        command=command,
        cases=tuple(heading_of(case, run) for case, run in runs),
        entries=tuple(entry_of(task, out) for task in tasks),
        published=suite.published,
        published_rings=suite.published_rings,
        published_filters=suite.published_filters,
        notes=suite.notes,
    )
    results.write(out, index)
    return index


def render_run(
    suite: Suite, case: Case, run: CaseRun, path: Path, workers: int, quality: Quality | None, stages: Stages
) -> None:
    """The run's data set: what the renderer resumes to the wanted frames, and has nothing to do where all are there."""
    from renderer.generate import generate

    frames = case.selected
    with stages(f"render {run.name}: {len(frames)} frames") as progress:
        generate(
            case.scenario,
            path,
            frames=frames,
            seed=run.seed,
            workers=workers,
            resume=path.exists(),
            quality=quality or case.quality or suite.quality,
            progress=progress,
        )
    dataset = Dataset.open(path)
    if list(dataset.frames) != list(frames):
        raise DatasetConflict(
            f"{path} holds {len(dataset.frames)} frames and case {run.name!r} wants {len(frames)} ({case.frames}); "
            "choose another --out"
        )


def bound_run(suite: Suite, case: Case, run: CaseRun, path: Path, out: Path, stages: Stages) -> None:
    """The information limit of the frames that the suite, or the case, names; found once, kept in ``out``."""
    frames = case.bounds or suite.bounds
    if frames is not None:
        samples = case.bound_samples or suite.bound_samples
        with stages(f"bound {run.name}: {len(case.bounded(frames))} frames") as progress:
            run_bounds.bounded(path, out, run.name, frames, samples, case, progress)


def refuse_unknown_methods(suite: Suite) -> None:
    """Before anything is rendered. One named by ``package.module:Class`` may come or not: that is its own matter."""
    for title, method in suite.methods.items():
        if ":" not in method.estimator and method.estimator not in registry.names():
            raise UsageError(f"methods.{title}.estimator: {unknown('method', method.estimator, registry.names())}")


def tasks_of(suite: Suite, case: Case, run: CaseRun, dataset: Path, out: Path, limits: Limits | None) -> Iterator[Task]:
    """Every method on everything of one data set that it answers."""
    for subject in case.subjects:
        for title, method in suite.methods_for(case, subject).items():
            yield Task(
                run=run,
                dataset=dataset,
                feature=subject.feature,
                rig=case.rig if subject.modality == "stereo" else None,
                lidar=subject.lidar,
                title=title,
                method=method,
                sigma_px=suite.prior_sigma_px if case.prior_sigma_px is None else case.prior_sigma_px,
                settle_s=case.settle_s,
                folder=out / ENTRIES / run.name / subject.name / title,
                limits=limits,
                reuse=limits is not None,
                bounds=run_bounds.path_of(out, run.name) if case.bounds or suite.bounds else None,
            )


def heading_of(case: Case, run: CaseRun) -> CaseHeading:
    """What the index says of a data set."""
    return CaseHeading(name=run.name, description=case.description, base=_base(run), seed=run.seed if _base(run) else None)


def entry_of(task: Task, out: Path) -> Entry:
    """What the index says of a method on a data set."""
    return Entry(
        case=task.run.name,
        feature=task.feature,
        title=task.title,
        dataset=task.dataset.relative_to(out).as_posix(),
        answers=task.folder.relative_to(out).as_posix(),
        scores=task.folder.relative_to(out).as_posix(),
    )


def _base(run: CaseRun) -> str | None:
    """The case that a run is one seed of, None for a case's only run."""
    return run.base if run.base != run.name else None
