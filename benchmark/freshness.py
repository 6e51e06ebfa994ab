"""Whether scores and pages that lie there would come out the same: a digest of all that they follow from, kept beside them."""

from collections.abc import Iterable
from functools import cache
from pathlib import Path

import benchmark
import scenes
from benchmark import predictions
from benchmark.files import publish
from benchmark.information.kept import BOUNDS
from benchmark.judge import SCORES, SUMMARY
from benchmark.results import INDEX, Entry, Results
from scenes.dataset import Dataset
from scenes.dataset_layout import TRUTH_TABLE
from scenes.provenance import sha256_of_bytes, sha256_of_json, software_versions

JUDGED, REPORTED = "judged.sha256", "report.sha256"
_SOURCES = (".py", ".j2", ".css", ".js", ".toml")
_ANSWERS = (predictions.TABLE, predictions.RECORD, predictions.EXTRAS)


def is_judged(folder: Path, dataset: Dataset, settle_s: float, bounds: Path | None = None) -> bool:
    """Whether ``folder`` holds the scores of its answers as this program would write them."""
    mark = folder / JUDGED
    return mark.is_file() and mark.read_text(encoding="utf-8") == _judgement(folder, dataset, settle_s, bounds)


def mark_judged(folder: Path, dataset: Dataset, settle_s: float, bounds: Path | None = None) -> None:
    """Says of the scores in ``folder`` what they were made of."""
    publish(folder, {JUDGED: _judgement(folder, dataset, settle_s, bounds).encode()})


def is_reported(folder: Path, index: Results) -> bool:
    """Whether ``folder`` holds the page of its results as this program would write it."""
    return (folder / REPORTED).is_file() and (folder / REPORTED).read_text(encoding="utf-8") == _page(folder, index)


def mark_reported(folder: Path, index: Results) -> None:
    """Says of the page in ``folder`` what it was made of."""
    publish(folder, {REPORTED: _page(folder, index).encode()})


def _judgement(folder: Path, dataset: Dataset, settle_s: float, bounds: Path | None) -> str:
    here = _digests(folder / name for name in (*_ANSWERS, SCORES, SUMMARY))
    truth = _digests([dataset.path / TRUTH_TABLE, dataset.path / BOUNDS if bounds is None else bounds])
    return sha256_of_json([_program(), dataset.identity, settle_s, truth, here])


def _page(folder: Path, index: Results) -> str:
    """Answers and scores stand for the data sets, whose identity they name."""
    from benchmark.report import PAGE  # loads what draws

    entries = [_digests(_files(folder, one)) for one in index.entries]
    return sha256_of_json([_program(), _digests([folder / INDEX, folder / PAGE]), entries])


def _files(folder: Path, entry: Entry) -> list[Path]:
    judged = [folder / entry.scores / name for name in (SCORES, SUMMARY)]
    return [folder / entry.answers / name for name in _ANSWERS] + judged


def _digests(paths: Iterable[Path]) -> list[str]:
    """SHA-256 of each file, empty for one that is not there."""
    return [sha256_of_bytes(path.read_bytes()) if path.is_file() else "" for path in paths]


@cache
def _program() -> str:
    """Digest of the sources that judge and make pages, and of the libraries' versions."""
    folders = [Path(package.__path__[0]) for package in (benchmark, scenes)]
    files = sorted(path for folder in folders for path in folder.rglob("*") if path.suffix in _SOURCES)
    return sha256_of_json([software_versions(), _digests(files)])
