"""Whether two rankings agree: the same divisions, their figures within bounds, nobody ahead of whom the other is ahead."""

from collections.abc import Iterator

from benchmark.ranking_record import Division, Ranking
from benchmark.reproduce_figures import Stated, of_estimate, stated_of

Compared = tuple[str, str, Stated | None, float | None]  # where, figure, the reference's (None: a fault without one), the re-run's


def compared(reference: Ranking, found: Ranking) -> Iterator[Compared]:
    """Every figure of the reference's divisions beside the re-run's, every division that lacks, every order that changed."""
    there = {_key(one): one for one in found.divisions}
    for division in reference.divisions:
        where = f"{division.modality}, {len(division.cases)} cases, {len(division.methods)} methods"
        other = there.get(_key(division))
        if other is None:
            yield where, "the ranking has no such division", None, None
            continue
        yield from _standings(where, division, other)
        yield from _differences(where, division, other)


def _key(division: Division) -> tuple[str, frozenset[str], frozenset[str], frozenset[str]]:
    methods = frozenset(one.method for one in division.methods)
    return division.modality, frozenset(division.cases), frozenset(division.subjects), methods


def _standings(where: str, reference: Division, found: Division) -> Iterator[Compared]:
    there = {one.method: stated_of(one) for one in found.methods}
    for standing in reference.methods:
        for name, figure in stated_of(standing).items():
            other = there[standing.method].get(name)
            yield f"{where}: {standing.method}", name, figure, None if other is None else other.value


def _differences(where: str, reference: Division, found: Division) -> Iterator[Compared]:
    """Pairs of methods: the difference of their charges, and the order where the reference is sure of one."""
    there = {(one.first, one.second): one for one in found.differences}
    there |= {(one.second, one.first): one.turned for one in found.differences}
    for pair in reference.differences:
        other, names = there.get((pair.first, pair.second)), f"{where}: {pair.first} − {pair.second}"
        value = None if other is None else other.charge.value
        yield names, "charge", of_estimate("charge", pair.charge), value
        if pair.better is not None and (other is None or other.better != pair.better):
            now = "is tied" if other is None or other.better is None else f"is behind {other.better}"
            yield names, f"{pair.better} was ahead and {now}", None, None
