"""The leaderboard: render or reuse each case's data set, let every method answer, judge, index. Tables and pages come after."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

from benchmark import judge, results, run
from benchmark.knowledge import declare
from benchmark.progress import Progress
from benchmark.results import CaseHeading, Entry, Results
from benchmark.suite import Case, Method, Suite
from scenes.dataset import Dataset
from scenes.errors import DatasetConflict
from scenes.features import CircleFeature
from scenes.scenario import Quality

Stages = Callable[[str], AbstractContextManager[Progress | None]]
_DATASETS, _ENTRIES = "datasets", "entries"


def _silent(_: str) -> AbstractContextManager[Progress | None]:
    return nullcontext(None)


def bench(suite: Suite, out: Path, *, workers: int = 1, quality: Quality | None = None, stages: Stages = _silent) -> Results:
    """Runs ``suite`` into ``out`` and returns its index, which is also written there as results.json.

    ``stages`` opens the progress of one stage by its title. Data sets already in ``out`` are reused where their digest
    fits, else refused; answers and scores are always made anew.
    """
    entries: list[Entry] = []
    for case in suite.cases:
        dataset = _dataset(suite, case, out / _DATASETS / case.name, workers, quality, stages)
        entries += _entries(suite, case, dataset, out, stages)
    index = Results(
        title=suite.title,
        description=suite.description,
        cases=tuple(CaseHeading(name=case.name, description=case.description) for case in suite.cases),
        entries=tuple(entries),
        published=suite.published,
        published_rings=suite.published_rings,
        notes=suite.notes,
    )
    results.write(out, index)
    return index


def _dataset(suite: Suite, case: Case, path: Path, workers: int, quality: Quality | None, stages: Stages) -> Dataset:
    """The case's data set: what the renderer resumes to the wanted frames, and has nothing to do where all are there."""
    from renderer.generate import generate

    frames = case.selected
    with stages(f"render {case.name}: {len(frames)} frames") as progress:
        generate(
            case.scenario,
            path,
            frames=frames,
            seed=case.seed,
            workers=workers,
            resume=path.exists(),
            quality=quality or case.quality or suite.quality,
            progress=progress,
        )
    dataset = Dataset.open(path)
    if list(dataset.frames) != list(frames):
        raise DatasetConflict(
            f"{path} holds {len(dataset.frames)} frames and case {case.name!r} wants {len(frames)} ({case.frames}); "
            "choose another --out"
        )
    return dataset


def _entries(suite: Suite, case: Case, dataset: Dataset, out: Path, stages: Stages) -> Iterator[Entry]:
    for feature in case.features:
        for title, method in suite.methods_of(case).items():
            folder = out / _ENTRIES / case.name / feature / title
            with stages(f"{title} on {case.name}, {feature}") as progress:
                _answer_and_judge(dataset, case, feature, title, method, suite.prior_sigma_px, folder, progress)
            yield Entry(
                case=case.name,
                feature=feature,
                title=title,
                dataset=dataset.path.relative_to(out).as_posix(),
                answers=folder.relative_to(out).as_posix(),
                scores=folder.relative_to(out).as_posix(),
            )


def _answer_and_judge(
    dataset: Dataset, case: Case, feature: str, title: str, method: Method, sigma_px: float, folder: Path, progress: Progress | None
) -> None:
    circles = {one.name for one in dataset.features if isinstance(one, CircleFeature)}
    rig = case.rig if feature in circles else None
    declaration = declare(dataset, feature, sigma_px, grant_aspect=method.aspect, grant_radius=method.radius, rig=rig)
    answers = run.estimate(method.estimator, method.parameters, dataset, declaration, folder, label=title, progress=progress)
    judge.write(folder, judge.judge(answers, dataset, case.settle_s))
