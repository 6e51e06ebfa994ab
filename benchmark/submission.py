"""``hardlight check``: everything that is wrong with a folder of answers at once, before anybody judges it."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from benchmark.errors import PredictionsError
from benchmark.judge import judge
from benchmark.predictions import EXTRAS, RECORD, TABLE, extras_faults, read, read_extras, record_and_faults, text_of
from benchmark.records import RunRecord
from benchmark.table_faults import Line, header_faults, lines, rows_of
from scenes.dataset import Dataset
from scenes.errors import HardlightError, unknown


@dataclass(frozen=True, slots=True)
class Findings:
    """``faults``: a sentence each, with file, line, field and value. ``notes``: what is allowed and may surprise."""

    faults: tuple[str, ...]
    notes: tuple[str, ...]


def examine(folder: Path, dataset: Dataset) -> Findings:
    """What is wrong with the answers in ``folder``, by themselves and as answers to ``dataset``; then they are judged on trial."""
    read_lines = list(_lines(folder))
    broken = [one for one in read_lines if isinstance(one, str)]
    whole = [one for one in read_lines if isinstance(one, Line)]
    faults = [*_of_record(folder, dataset), *broken, *_of_lines(whole, folder / TABLE, dataset), *_of_extras(folder, whole)]
    if not faults and not whole:
        faults.append(f"{folder / TABLE} has no line; a method answers every frame, if only with 'skipped'")
    return Findings(tuple(faults or _of_judging(folder, dataset)), tuple(_notes(whole, dataset)))


def _of_record(folder: Path, dataset: Dataset) -> list[str]:
    try:
        record, faults = record_and_faults(folder)
    except PredictionsError as error:
        return [str(error)]
    return faults if record is None else list(_of_declaration(record, folder / RECORD, dataset))


def _of_declaration(record: RunRecord, path: Path, dataset: Dataset) -> Iterator[str]:
    if record.dataset_identity != dataset.identity:
        yield f"{path}: dataset_identity is {record.dataset_identity}, and {dataset.path} is data set {dataset.identity}"
    knowledge, features = record.knowledge, [one.name for one in dataset.features]
    if knowledge is not None and knowledge.feature is not None and knowledge.feature not in features:
        yield f"{path}: knowledge.feature: {unknown('feature', knowledge.feature, features)}"
    pair = None if knowledge is None else knowledge.pair
    for side, name in (("left", pair.left), ("right", pair.right)) if pair is not None else ():
        if name not in dataset.sensors:
            yield f"{path}: knowledge.pair.{side}: {unknown('sensor', name, dataset.sensors)}"


def _lines(folder: Path) -> Iterator[Line | str]:
    """The lines that could be read, or why none could."""
    path = folder / TABLE
    try:
        rows = rows_of(text_of(path), str(path))
    except PredictionsError as error:
        yield str(error)
        return
    found = header_faults(rows, str(path))
    yield from found or lines(rows, str(path))


def _of_lines(read_lines: list[Line], path: Path, dataset: Dataset) -> Iterator[str]:
    """The faults of each line, those that only the data set shows among them."""
    frames, known = dataset.frames, {*dataset.sensors, *dataset.lidars}
    there = f"which {dataset.path} does not have ({frames[0]} to {frames[-1]})"
    for line in read_lines:
        yield from line.faults
        where, values = f"{path}, line {line.number}", line.values
        if "frame" in values and values["frame"] not in set(frames):
            yield f"{where}: frame is {values['frame']}, {there}"
        if values and values["sensor"] not in known:
            yield f"{where}: sensor: {unknown('sensor', values['sensor'], known)}"


def _of_extras(folder: Path, read_lines: list[Line]) -> Iterator[str]:
    path = folder / EXTRAS
    try:
        extras = read_extras(folder)
    except PredictionsError as error:
        yield str(error)
        return
    faults = extras_faults(extras, path)
    yield from faults
    if extras is None or faults or extras.empty:
        return
    answered = {(line.values["frame"], line.values["sensor"]) for line in read_lines if "frame" in line.values}
    for frame, sensor in zip(extras["frame"], extras["sensor"], strict=True):
        if (frame, sensor) not in answered:
            yield f"{path}: frame {frame} of {sensor!r} has no line in {TABLE}"


def _of_judging(folder: Path, dataset: Dataset) -> list[str]:
    """What the judge refuses, although it is well written."""
    try:
        judge(read(folder), dataset)
    except HardlightError as error:
        return [str(error)]
    return []


def _notes(read_lines: list[Line], dataset: Dataset) -> Iterator[str]:
    """Frames without a line count as failures, which is allowed and rarely meant."""
    by_sensor: dict[str, set[int]] = {}
    for line in read_lines:
        if "frame" in line.values:
            by_sensor.setdefault(line.values["sensor"], set()).add(line.values["frame"])
    for sensor, answered in by_sensor.items():
        missing = [frame for frame in dataset.frames if frame not in answered]
        if missing:
            share = f"{len(missing)} of {len(dataset.frames)} frames"
            yield f"{sensor}: {share} have no line (the first is {missing[0]}) and count as skipped"
