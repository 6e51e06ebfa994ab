"""What is kept of a bench's results: index, ranking, page, summaries, small answers, digests of frames; no frames, no scores."""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path, PurePosixPath

from benchmark import ranking, results
from benchmark.errors import PredictionsError, ResultsConflict
from benchmark.judge import SUMMARY
from benchmark.predictions import RECORD, TABLE
from benchmark.records import MachineRecord, RunRecord
from benchmark.reference import FRAMES, MANIFEST, Reference, ReferenceDataset, frame_digests
from benchmark.report import PAGE
from benchmark.results import INDEX, Entry, Results
from scenes.dataset import Dataset
from scenes.dataset_layout import FRAMES as FRAMES_FOLDER
from scenes.errors import StorageError
from scenes.provenance import readable_json, sha256_of_bytes, software_versions

LARGEST_ANSWERS = 64 * 1024  # bytes of a predictions.csv that is kept: some 200 frames; longer ones say little to a reader
_KEPT = frozenset({MANIFEST, INDEX, ranking.FILE, PAGE, SUMMARY, RECORD, TABLE, FRAMES})


def archive(folder: Path, target: Path) -> Reference:
    """Keeps in ``target`` what is small of the results in ``folder``, whole or not at all; returns its manifest.

    Replaces what was kept there of the same suite. Raises ``ResultsConflict`` where anything else is there, ``PredictionsError``
    or ``DatasetError`` where the results or their data sets are incomplete or do not belong together.
    """
    index, target = results.read(folder), target.absolute()
    refuse_other(target, index.title, _KEPT, INDEX, lambda kept: results.read(kept).title)
    _refuse_paths_outside(folder, index)
    datasets = {path: Dataset.open(folder / path) for path in sorted({entry.dataset for entry in index.entries})}
    contents = dict(_files(folder, index, datasets))
    reference = Reference(
        title=index.title,
        command=_command(index),
        software=software_versions(),
        machines=_machines(contents),
        datasets={path: ReferenceDataset(identity=one.identity, frames=one.manifest.frame_count) for path, one in datasets.items()},
        files={name: sha256_of_bytes(data) for name, data in sorted(contents.items())},
    )
    publish_whole(target, contents | {MANIFEST: readable_json(reference.model_dump()).encode()})
    return reference


def require_datasets(folder: Path) -> None:
    """Raises ``PredictionsError`` where results lie without their data sets, from which the page's pictures are made."""
    index = results.read(folder)
    paths = sorted({entry.dataset for entry in index.entries})
    if paths and not any((folder / path / FRAMES_FOLDER).is_dir() for path in paths):
        again = f"; {command} makes results with data sets" if (command := _command(index)) else ""
        there = f"; its {PAGE} was made with them and is left as it is" if (folder / PAGE).is_file() else ""
        raise PredictionsError(f"{folder} holds results without data sets, which the page's pictures are made from{there}{again}")


def _files(folder: Path, index: Results, datasets: dict[str, Dataset]) -> Iterator[tuple[str, bytes]]:
    """Path in the archive → bytes, of everything but the manifest."""
    yield INDEX, (folder / INDEX).read_bytes()
    if (folder / ranking.FILE).is_file():
        ranking.read(folder)  # refused here rather than by whoever compares with it
        yield ranking.FILE, (folder / ranking.FILE).read_bytes()
    if (folder / PAGE).is_file():
        yield PAGE, (folder / PAGE).read_bytes()
    for path, dataset in datasets.items():
        yield f"{path}/{MANIFEST}", (dataset.path / MANIFEST).read_bytes()
        yield f"{path}/{FRAMES}", readable_json(frame_digests(dataset.path)).encode()
    for entry in index.entries:
        _refuse_other_dataset(folder, entry, datasets[entry.dataset])
        yield f"{entry.scores}/{SUMMARY}", (folder / entry.scores / SUMMARY).read_bytes()
        yield f"{entry.answers}/{RECORD}", (folder / entry.answers / RECORD).read_bytes()
        answers = folder / entry.answers / TABLE
        if answers.stat().st_size <= LARGEST_ANSWERS:
            yield f"{entry.answers}/{TABLE}", answers.read_bytes()


def _command(index: Results) -> str:
    """What made the results; of those that do not say, the bench of the library's suite with their description, or nothing."""
    from scenes.config import list_library

    if index.command:
        return index.command
    names = [name for name, description in list_library("suites").items() if index.description and description == index.description]
    return f"hardlight bench {names[0]} --out out/{names[0]}" if names else ""


def _machines(contents: dict[str, bytes]) -> tuple[MachineRecord, ...]:
    runs = [data for name, data in contents.items() if name.endswith(f"/{RECORD}")]
    return tuple(dict.fromkeys(RunRecord.model_validate_json(data).machine for data in runs))


def refuse_other(target: Path, title: str, kept: frozenset[str], index: str, title_of: Callable[[Path], str]) -> None:
    """Raises ``ResultsConflict`` unless nothing is at ``target``, or what was kept of the same and no more.

    ``kept``: names of files that may lie there; ``index``: the one that has to, from which ``title_of`` reads the title.
    """
    if not target.exists() and not target.is_symlink():
        return
    if target.is_symlink() or not target.is_dir():
        raise ResultsConflict(f"{target} is there and is no folder; choose another --to")
    files = [path for path in sorted(target.rglob("*")) if path.is_symlink() or not path.is_dir()]
    strange = next((path for path in files if path.name not in kept or path.is_symlink()), None)
    if strange is not None:
        raise ResultsConflict(f"{target} holds {strange.relative_to(target)}, which is not of an archive; choose another --to")
    if files and not (target / index).is_file():
        raise ResultsConflict(f"{target} holds files and no {index}; choose another --to")
    if files and (there := title_of(target)) != title:
        raise ResultsConflict(f"{target} is the archive of {there!r}, not of {title!r}; choose another --to")


def _refuse_paths_outside(folder: Path, index: Results) -> None:
    """Only what bench made lies in one folder; the paths of an index become those of the archive."""
    for path in {path for entry in index.entries for path in (entry.dataset, entry.answers, entry.scores)}:
        parts = PurePosixPath(path)
        if parts.is_absolute() or not parts.parts or ".." in parts.parts:
            raise PredictionsError(f"{folder / INDEX} names {path!r}; only the --out folder of hardlight bench can be archived")


def _refuse_other_dataset(folder: Path, entry: Entry, dataset: Dataset) -> None:
    for summary in results.summaries(folder, entry):
        if summary.dataset_identity != dataset.identity:
            raise PredictionsError(
                f"{folder / entry.scores / SUMMARY} is of data set {summary.dataset_identity:.12}, {dataset.path} is "
                f"{dataset.identity:.12}; run hardlight bench again"
            )


def publish_whole(target: Path, contents: dict[str, bytes]) -> None:
    """The folder beside its name first, then renamed over what was there."""
    beside, before = (target.parent / f".{target.name}.{kind}-{os.getpid()}" for kind in ("partial", "before"))
    try:
        for name, data in contents.items():
            path = beside / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        if target.exists():
            target.rename(before)
        beside.rename(target)
    except OSError as error:
        if before.exists() and not target.exists():
            before.rename(target)
        raise StorageError(f"cannot write to {target}: {error.strerror or error}") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)
        if target.exists():
            shutil.rmtree(before, ignore_errors=True)
