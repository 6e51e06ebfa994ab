"""A suite that includes others: their methods, cases, published figures and notes as one, each case under its own suite's rules."""

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from benchmark.suite import Method, Suite

T = TypeVar("T")


def merged(suite: "Suite") -> "Suite":
    """``suite`` with what it includes in front of its own, nothing of it checked again.

    A case keeps prior, limits and methods of the suite that it comes from, quality and bounds where that says any. Cases of one
    name are told apart by their suites' names in front, and are one where they are equal in everything. Raises ``ValueError`` where
    a method's name means two things.
    """
    parts = [one for one in (*suite.include, suite.model_copy(update={"include": ()})) if one.cases or one.methods]
    methods = _methods(parts)
    parts = _told_apart([_ruled(part) for part in parts])
    return suite.model_copy(
        update={
            "include": (),
            "methods": methods,
            "cases": _once(case for part in parts for case in part.cases),
            "published": _once(one for part in parts for one in part.published),
            "published_rings": _once(one for part in parts for one in part.published_rings),
            "published_filters": _once(one for part in parts for one in part.published_filters),
            "notes": _once(one for part in (*parts, suite) for one in part.notes),
        }
    )


def _methods(parts: Sequence["Suite"]) -> dict[str, "Method"]:
    found: dict[str, tuple[Method, Suite]] = {}
    for part in parts:
        for name, method in part.methods.items():
            other, owner = found.setdefault(name, (method, part))
            if other != method:
                raise ValueError(
                    f"include: the method {name!r} is one thing in {owner.name!r} and another in {part.name!r}; "
                    "give one of them another name"
                )
    return {name: method for name, (method, _) in found.items()}


def _ruled(part: "Suite") -> "Suite":
    """``part`` with its own rules written into each case that does not say otherwise."""
    cases = tuple(
        case.model_copy(
            update={
                "quality": case.quality or part.quality,
                "prior_sigma_px": part.prior_sigma_px if case.prior_sigma_px is None else case.prior_sigma_px,
                "limits": case.limits or part.limits,
                "bounds": case.bounds or part.bounds,
                "bound_samples": case.bound_samples or part.bound_samples,
                "methods": case.methods or tuple(part.methods),
            }
        )
        for case in part.cases
    )
    return part.model_copy(update={"cases": cases})


def _told_apart(parts: Sequence["Suite"]) -> list["Suite"]:
    """``parts`` with their suite's name in front of the names of cases that mean different things in different suites."""
    counts = Counter(case.name for case in _once(case for part in parts for case in part.cases))
    return [_renamed(part, {case.name for case in part.cases if counts[case.name] > 1}) for part in parts]


def _renamed(part: "Suite", taken: set[str]) -> "Suite":
    def name(one: str) -> str:
        return f"{part.name}-{one}" if one in taken else one

    return part.model_copy(
        update={
            "cases": tuple(case.model_copy(update={"name": name(case.name)}) for case in part.cases),
            "published": tuple(one.model_copy(update={"case": name(one.case)}) for one in part.published),
            "published_rings": tuple(one.model_copy(update={"case": name(one.case)}) for one in part.published_rings),
            "published_filters": tuple(one.model_copy(update={"case": name(one.case)}) for one in part.published_filters),
        }
    )


def _once(values: Iterable[T]) -> tuple[T, ...]:
    """The values without repetitions, in order of appearance; they need not be hashable."""
    kept: list[T] = []
    for value in values:
        if value not in kept:
            kept.append(value)
    return tuple(kept)
