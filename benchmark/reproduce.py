"""Whether a re-run reproduces a reference: the same entries, and every figure inside the bounds that the reference states."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np

from benchmark import ranking, reference, results
from benchmark.reproduce_figures import Stated, Verdict, stated
from benchmark.reproduce_ranks import compared
from benchmark.results import Entry
from benchmark.summary import Summary

Group = Literal["same data", "other data", "ranking"]
_Key = tuple[str, str, str, str]
_Listed = dict[_Key, tuple[Entry, Summary]]


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """One figure of the reference beside the re-run's; ``stated`` is None for what is missing and for a change of ranks."""

    group: Group
    where: str
    figure: str
    stated: Stated | None
    found: float | None

    @property
    def verdict(self) -> Verdict:
        """A fault without a figure counts as outside."""
        return "outside" if self.stated is None else self.stated.verdict(self.found)


@dataclass(frozen=True, eq=False)
class Comparison:
    """What came of it. ``strange``: data set of a case → in what it differs from the reference's.

    ``cpu_ratio``: median over the entries of the re-run's CPU per frame to the reference's, not judged. ``added``: entries that
    the reference does not have. ``unranked``: why ranks were not compared, empty where they were.
    """

    judged: tuple[Judged, ...]
    entries: Counter[Group]
    missing: tuple[str, ...]
    strange: dict[str, str]
    added: int
    cpu_ratio: float | None
    unranked: str

    @cached_property
    def outside(self) -> tuple[Judged, ...]:
        """The figures that are not reproduced."""
        return tuple(one for one in self.judged if one.verdict == "outside")

    @property
    def is_reproduced(self) -> bool:
        """Whether nothing is outside and nothing is missing."""
        return not self.outside and not self.missing

    def counts(self, group: Group) -> Counter[Verdict]:
        """Figures of a group by verdict."""
        return Counter(one.verdict for one in self.judged if one.group == group)


def compare(kept: Path, out: Path) -> Comparison:
    """The reference in ``kept`` against the results in ``out``. Raises ``PredictionsError`` where one is missing or damaged."""
    there, here = _listed(kept), _listed(out)
    strange = _strange_datasets(kept, out, there, here)
    judged: list[Judged] = []
    entries: Counter[Group] = Counter()
    for key in (one for one in there if one in here):
        group: Group = "other data" if there[key][0].case in strange else "same data"
        entries[group] += 1
        judged += _judged(group, _name(key), there[key][1], here[key][1])
    unranked = _why_unranked(kept, out)
    if not unranked:
        judged += (Judged("ranking", *one) for one in compared(ranking.read(kept), ranking.read(out)))
    return Comparison(
        judged=tuple(judged),
        entries=entries,
        missing=tuple(_name(key) for key in there if key not in here),
        strange=strange,
        added=len(here.keys() - there.keys()),
        cpu_ratio=_cpu_ratio(there, here),
        unranked=unranked,
    )


def _listed(folder: Path) -> _Listed:
    """Every summary of the results in a folder, by case, feature, method and sensor."""
    every = [(entry, one) for entry in results.read(folder).entries for one in results.summaries(folder, entry)]
    return {(entry.case, entry.feature or "", entry.title, one.sensor): (entry, one) for entry, one in every}


def _name(key: _Key) -> str:
    return ", ".join(part for part in key if part)


def _judged(group: Group, where: str, there: Summary, here: Summary) -> Iterator[Judged]:
    found = stated(here)
    for name, figure in stated(there).items():
        yield Judged(group, where, name, figure, found[name].value if name in found else None)


def _strange_datasets(kept: Path, out: Path, there: _Listed, here: _Listed) -> dict[str, str]:
    """Cases whose data sets are not the same bytes. Where a side has neither frames nor digests, the identity has to do."""
    strange: dict[str, str] = {}
    pairs = {there[key][0].case: (there[key], here[key]) for key in there if key in here}
    for case, ((old, before), (new, now)) in pairs.items():
        if before.dataset_identity != now.dataset_identity:
            strange[case] = f"identity {before.dataset_identity:.12} in the reference, {now.dataset_identity:.12} in the re-run"
            continue
        ours, theirs = reference.frame_digests(kept / old.dataset), reference.frame_digests(out / new.dataset)
        if ours is not None and theirs is not None and ours != theirs:
            differing = sum(ours.get(frame) != theirs.get(frame) for frame in ours.keys() | theirs.keys())
            strange[case] = f"same identity, {differing} of {len(ours)} frames have other bytes"
    return strange


def _why_unranked(kept: Path, out: Path) -> str:
    lacking = [folder for folder in (kept, out) if not (folder / ranking.FILE).is_file()]
    if lacking:
        return f"{lacking[0]} has no {ranking.FILE}"
    return "" if ranking.read(kept).rule == ranking.read(out).rule else "they were ranked by different rules"


def _cpu_ratio(there: _Listed, here: _Listed) -> float | None:
    pairs = [(there[key][1].cpu_s_per_frame, here[key][1].cpu_s_per_frame) for key in there.keys() & here.keys()]
    ratios = [new / old for old, new in pairs if old and new]
    return float(np.median(ratios)) if ratios else None
