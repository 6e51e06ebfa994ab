"""What methods were told in advance, from the summaries: in a few words for a table, in full for a method's own page."""

from collections.abc import Iterator, Sequence

from benchmark.leaderboard import Row
from benchmark.records import KnowledgeRecord

_NOT_DECLARED = "not declared"


def told(rows: Sequence[Row]) -> dict[str, list[str]]:
    """Method → everything that it was told in any case, each fact once."""
    found: dict[str, list[str]] = {}
    for row in rows:
        knowledge = row.summary.knowledge
        facts = [_NOT_DECLARED] if knowledge is None else knowledge.facts(named=False)
        known = found.setdefault(row.entry.title, [])
        known += [fact for fact in facts if fact not in known]
    return found


def told_in_short(rows: Sequence[Row]) -> dict[str, str]:
    """Method → what it was told besides the calibration of its sensors, which all are told, in a few words."""
    found: dict[str, list[str]] = {}
    for row in rows:
        known = found.setdefault(row.entry.title, [])
        known += [fact for fact in _short(row.summary.knowledge) if fact not in known]
    return {title: ", ".join(facts) or "calibration alone" for title, facts in found.items()}


def _short(knowledge: KnowledgeRecord | None) -> Iterator[str]:
    if knowledge is None:
        yield _NOT_DECLARED
        return
    if knowledge.feature is not None:
        yield "the rectangle’s place" if knowledge.pair is None else "the ring’s place"
    for name, words in (
        ("aspect", "its aspect"),
        ("radius_m", "its radius"),
        ("corner_prior", "first corners"),
        ("model", "the target’s surface"),
    ):
        if getattr(knowledge, name) is not None:
            yield words
