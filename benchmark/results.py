"""results.json: the index of a folder of results, from which the table and the page are made. Paths are relative to it."""

import json
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, ValidationError

from benchmark.errors import PredictionsError, damaged
from benchmark.files import publish
from benchmark.judge import SUMMARY
from benchmark.published import Published, PublishedFilter, PublishedRing
from benchmark.suite import Note
from benchmark.summary import Summary
from scenes.spec import Spec, is_empty

INDEX = "results.json"


class Entry(Spec):
    """One method on one feature of one case: where its data set, its answers and its scores lie."""

    case: str
    feature: str | None
    title: str
    dataset: str
    answers: str
    scores: str


class CaseHeading(Spec):
    """What a case is about, in a line. Of a case that is run with several seeds, ``base`` is the case's name."""

    name: str
    description: str = ""
    base: str | None = None
    seed: int | None = None


class Results(Spec):
    """What a bench or a single judgement left behind. ``command`` made it; empty where that is not known."""

    format: Literal["hardlight-results"] = "hardlight-results"
    version: Literal[1] = 1
    title: str
    description: str = ""
    command: Annotated[str, Field(exclude_if=is_empty)] = ""
    cases: tuple[CaseHeading, ...]
    entries: tuple[Entry, ...]
    published: tuple[Published, ...] = ()
    published_rings: tuple[PublishedRing, ...] = ()
    published_filters: tuple[PublishedFilter, ...] = ()
    notes: tuple[Note, ...] = ()

    @property
    def bases(self) -> dict[str, str]:
        """Of the cases that are one seed of another case: their name → that case's."""
        return {case.name: case.base for case in self.cases if case.base is not None}


def write(folder: Path, results: Results) -> None:
    """Writes results.json."""
    publish(folder, {INDEX: (results.model_dump_json(indent=2) + "\n").encode()})


def read(folder: Path) -> Results:
    """The index of ``folder``. Raises ``PredictionsError`` where there is none or it is not one."""
    path = folder / INDEX
    if not path.is_file():
        raise PredictionsError(f"{folder} holds no {INDEX}; give the --out folder of hardlight bench, judge or demo")
    try:
        return Results.model_validate_json(path.read_bytes())
    except ValidationError as error:
        raise damaged(path, error) from error


def summaries(folder: Path, entry: Entry) -> tuple[Summary, ...]:
    """The summaries of one entry, one per sensor."""
    path = folder / entry.scores / SUMMARY
    try:
        return tuple(Summary.model_validate(one) for one in json.loads(path.read_text(encoding="utf-8")))
    except FileNotFoundError:
        raise PredictionsError(f"{path} does not exist; run the judge again") from None
    except ValidationError as error:
        raise damaged(path, error) from error
    except ValueError as error:
        raise PredictionsError(f"{path} is damaged: {error}") from error
