"""What is kept of a study: its record, points, scores and page, and which data sets they are of; no frames."""

from pathlib import Path

from benchmark.archive import publish_whole, refuse_other
from benchmark.report import PAGE
from benchmark.results import read as read_index
from benchmark.study import outcomes, record, scores
from benchmark.study.score_record import LevelScore, Overall, StudyScores
from scenes.dataset import Dataset
from scenes.errors import UsageError
from scenes.provenance import readable_json

POINTS, DATASETS = "points.csv", "datasets.json"
_KEPT = frozenset({record.FILE, scores.FILE, PAGE, POINTS, DATASETS})
_SLACK = 1e-9  # of figures that are the same but for the last bits of a mean


def is_study(folder: Path) -> bool:
    """Whether ``folder`` is a study's, or what was kept of one."""
    return (folder / record.FILE).is_file()


def archive(folder: Path, target: Path) -> list[str]:
    """Keeps in ``target`` what is small of the study in ``folder``, in place of what was kept there of the same; returns the names.

    Raises ``ResultsConflict`` where anything else is there, ``PredictionsError`` where the study is not whole.
    """
    said, found, target = record.read(folder), scores.read(folder), target.absolute()
    refuse_other(target, said.title, _KEPT, record.FILE, lambda kept: record.read(kept).title)
    paths = {entry.dataset for entry in read_index(folder).entries}
    contents = {
        record.FILE: (folder / record.FILE).read_bytes(),
        scores.FILE: (found.model_dump_json(indent=1) + "\n").encode(),
        POINTS: outcomes.read_points(folder).to_csv(index=False).encode(),
        DATASETS: readable_json({Path(path).name: Dataset.open(folder / path).identity for path in sorted(paths)}).encode(),
    }
    if (folder / PAGE).is_file():
        contents[PAGE] = (folder / PAGE).read_bytes()
    publish_whole(target, contents)
    return sorted(contents)


def differences(kept: Path, again: Path) -> list[str]:
    """What of a kept study a re-run does not reproduce: a figure outside of the kept one's interval, a method or level missing."""
    before, after = scores.read(kept), scores.read(again)
    there = {_key(one): one for one in _figures(after)}
    found = []
    for one in _figures(before):
        other = there.get(_key(one))
        if other is None:
            found.append(f"{_name(one)}: it is not there")
            continue
        for what in ("availability", "charge"):
            was, now = getattr(one, what), getattr(other, what)
            low, high = was.low if was.low is not None else was.value, was.high if was.high is not None else was.value
            if not low - _SLACK <= now.value <= high + _SLACK:
                found.append(f"{_name(one)}: {what} {now.value:.4g}, kept {was.value:.4g} ({low:.4g} to {high:.4g})")
    return found


def _figures(found: StudyScores) -> list[Overall | LevelScore]:
    return [*found.overall, *found.levels]


def _key(one: Overall | LevelScore) -> tuple[str, ...]:
    return (one.modality, one.method, *((one.factor, str(one.value), str(one.direction)) if isinstance(one, LevelScore) else ()))


def _name(one: Overall | LevelScore) -> str:
    return f"{one.method}, {one.label}" if isinstance(one, LevelScore) else f"{one.method}, all points"


def require_study(kept: Path, again: Path) -> None:
    """Raises ``UsageError`` where only one of two folders is a study's."""
    if is_study(kept) != is_study(again):
        raise UsageError(f"one of {kept} and {again} is of a study and the other is not, so they cannot be compared")
