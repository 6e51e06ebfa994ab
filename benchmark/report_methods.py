"""A page of the report per method: what made it, what it was told, what came of it, case by case, and why it has no answers."""

import json
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from benchmark import predictions
from benchmark.leaderboard import Overall, Row, overall
from benchmark.pool import TRACK
from benchmark.ranking_record import Ranking, Standing
from benchmark.records import MachineRecord, RunRecord
from benchmark.report_board import standings
from benchmark.report_pooled import PooledLine, pooled_lines
from benchmark.report_told import told
from benchmark.slugs import slugs

_REASONS, _REASON_LENGTH, _DIGEST = 6, 240, 16


@dataclass(frozen=True, slots=True, eq=False)
class Reason:
    """Why frames have no answer, in the method's own words (untrusted text), and how many frames that was."""

    outcome: str
    text: str
    frames: int


@dataclass(frozen=True, slots=True, eq=False)
class MethodView:
    """One method's page. Texts of ``made_of`` (name, value) and ``reasons`` come from whoever made the answers."""

    title: str
    slug: str
    series: int
    told: tuple[str, ...]
    made_of: tuple[tuple[str, str], ...]
    standings: tuple[tuple[str, Standing, int], ...]
    outcomes: tuple[tuple[str, int], ...]
    totals: Overall
    lines: tuple[PooledLine, ...]
    reasons: tuple[Reason, ...]


def slugs_of(titles: Sequence[str]) -> dict[str, str]:
    """Method → the id of its page."""
    return slugs(titles, "method-")


def method_views(
    folder: Path, rows: Sequence[Row], frames: pd.DataFrame, found: Ranking, titles: Sequence[str]
) -> tuple[MethodView, ...]:
    """A view of each of the ``titles``, in their order; ``frames`` are ``benchmark.pool.pool``'s."""
    ids, facts, counted = slugs_of(titles), told(rows), {one.title: one for one in overall(rows)}
    lines = list(pooled_lines(frames, titles))
    views = []
    for series, title in enumerate(titles):
        mine = frames[frames["method"] == title]
        outcomes = mine["outcome"].value_counts(sort=False).sort_index()
        views.append(
            MethodView(
                title=title,
                slug=ids[title],
                series=series,
                told=tuple(facts[title]),
                made_of=tuple(_made_of(list(_records(folder, rows, title)))),
                standings=tuple(standings(found, title)),
                outcomes=tuple((str(name), int(count)) for name, count in outcomes.items()),
                totals=counted[title],
                lines=tuple(line for line in lines if line.method == title),
                reasons=tuple(_reasons(folder, mine)),
            )
        )
    return tuple(views)


def _records(folder: Path, rows: Sequence[Row], title: str) -> Iterator[RunRecord]:
    """run.json of each of the method's entries."""
    for answers in dict.fromkeys(row.entry.answers for row in rows if row.entry.title == title):
        yield predictions.read_record(folder / answers)


def _made_of(records: Sequence[RunRecord]) -> Iterator[tuple[str, str]]:
    """What the records say of the method and of where it ran, each different thing once."""
    yield "estimator", _each(record.method for record in records)
    yield "version", _each(record.method_version or "not stated" for record in records)
    yield "parameters", _each(_parameters(record.parameters) for record in records)
    yield "sources", _each(record.method_source[:_DIGEST] or "no digest" for record in records)
    yield "machine", _each(machine(record.machine) for record in records)


def _each(texts: Iterator[str]) -> str:
    return "; ".join(dict.fromkeys(texts))


def _parameters(parameters: dict[str, Any]) -> str:
    return ", ".join(f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in parameters.items()) or "as by default"


def machine(one: MachineRecord) -> str:
    """Where answers were computed, as far as it was written down."""
    parts = (one.processor, f"{one.cores} cores" if one.cores else "", one.system, f"Python {one.python}" if one.python else "")
    return ", ".join(part for part in parts if part) or "not stated"


def _reasons(folder: Path, mine: pd.DataFrame) -> Iterator[Reason]:
    """The most frequent reasons of judged frames without an answer; those that differ in numbers alone count together."""
    silent = mine[~mine["answered"].astype(bool)]
    counts: Counter[tuple[str, str]] = Counter()
    shown: dict[tuple[str, str], str] = {}
    for (_, _, _, answers), part in silent.groupby([*TRACK, "answers"], sort=False):
        extras = predictions.read_extras(folder / str(answers))
        texts = _texts(extras, part)
        for outcome, text in zip(part["outcome"], texts, strict=True):
            key = str(outcome), re.sub(r"[-+]?\d[\d.,e]*", "#", text)
            counts[key] += 1
            shown.setdefault(key, text)
    for key, count in counts.most_common(_REASONS):
        yield Reason(key[0], _cut(shown[key]) or "no reason given", count)


def _texts(extras: pd.DataFrame | None, part: pd.DataFrame) -> list[str]:
    """The reason of each frame of one track, empty where none was given."""
    if extras is None or not {"frame", "sensor", "reason"}.issubset(extras):
        return [""] * len(part)
    of_sensor = extras[extras["sensor"] == part["sensor"].iloc[0]]
    known = dict(zip(of_sensor["frame"], of_sensor["reason"], strict=True))
    given = (known.get(frame) for frame in part["frame"])
    return [" ".join(one.split()) if isinstance(one, str) else "" for one in given]


def _cut(text: str) -> str:
    return text if len(text) <= _REASON_LENGTH else text[: _REASON_LENGTH - 1] + "…"
