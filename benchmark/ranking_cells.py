"""Rankings as texts: the lines of a division's table, its title, and numbers short enough to stand in a column."""

from collections.abc import Sequence

import numpy as np

from benchmark.ranking_record import Division, Estimate, Ranking, Standing

_NAMED = 3  # cases or subjects in a title; of more the first, and how many more there are
_TINY, _SMALL, _LARGE = 1e-3, 0.1, 1e5


def legend(found: Ranking) -> str:
    """What the columns are over and what a tie is, in two lines; where one is known, in a third what efficiency is."""
    guess_deg, level = np.degrees(found.rule.unanswered_rad), found.rule.confidence
    near = any(one.efficiency is not None for division in found.divisions for one in division.methods)
    told = "\nEfficiency: 1 where errors are what light and noise leave, 1/4 at twice that; of answered frames." if near else ""
    return (
        f"All frames count: one without an answer, or wrong, is charged {guess_deg:.1f}° and, of positions, the whole range.\n"
        f"Medians and p95 take it as larger than any error. Second lines: {level:.0%} intervals. 1= is a tie.{told}"
    )


def title(division: Division) -> str:
    """Which methods are compared on what: the modality, cases, subjects, tracks and frames."""
    return (
        f"{division.modality}: {some(division.cases)} ({some(division.subjects)}); "
        f"{counted(division.tracks, 'track')}, {counted(division.frames, 'frame')}"
    )


def cells(division: Division) -> list[dict[str, str]]:
    """A line per method, best first; each figure but the tails with its interval on a second line."""
    are_bounded = any(one.efficiency is not None for one in division.methods)
    near = [{"effi-\nciency": f"{ratio(one.efficiency)}\n{ratio_interval(one.efficiency)}".rstrip()} for one in division.methods]
    return [_line(one) | (more if are_bounded else {}) for one, more in zip(division.methods, near, strict=True)]


def rank(standing: Standing) -> str:
    """``1``, or ``1=`` for a tie."""
    return f"{standing.rank}{'=' if standing.is_tied else ''}"


def figure(estimate: Estimate | None, scale: float = 1.0) -> str:
    """The figure; a dash where there is none, or a quantile falls among the frames without an answer."""
    return "—" if estimate is None or estimate.value is None else short(scale * estimate.value)


def interval(estimate: Estimate | None, scale: float = 1.0, between: str = "–") -> str:
    """``low–high``; ∞ where a bound falls among the frames without an answer; empty where there is none, or no width.

    A dash before a minus cannot be read: where ``low`` is negative the word stands that a sentence would have.
    """
    if estimate is None or estimate.low is None or estimate.low == estimate.high:
        return ""
    joint = " to " if between == "–" and scale * estimate.low < 0.0 else between
    if estimate.high is None:
        return f"{short(scale * estimate.low)}{joint}∞"
    finest = _decimals(scale * estimate.high)
    return f"{short(scale * estimate.low, finest)}{joint}{short(scale * estimate.high)}"


def ratio(estimate: Estimate | None) -> str:
    """An efficiency, which may be tiny; a dash where there is none."""
    return "—" if estimate is None or estimate.value is None else _tiny(estimate.value)


def ratio_interval(estimate: Estimate | None, between: str = "–") -> str:
    """``low–high`` of an efficiency; empty where there is none, or no width."""
    if estimate is None or estimate.low is None or estimate.high is None or estimate.low == estimate.high:
        return ""
    return f"{_tiny(estimate.low)}{between}{_tiny(estimate.high)}"


def _tiny(value: float) -> str:
    return f"{value:.0e}" if 0.0 < value < _TINY else short(value)


def short(value: float, finest: int = 4) -> str:
    """Three significant digits, two below 0.1, in at most ``finest`` decimals; an exponent where it would be long; 0 for zero."""
    if value == 0.0:
        return "0"
    return f"{value:.0e}" if abs(value) >= _LARGE else f"{value:.{min(_decimals(value), finest)}f}"


def _decimals(value: float) -> int:
    size = abs(value)
    return 4 if size == 0.0 else int(np.clip((2 if size >= _SMALL else 1) - np.floor(np.log10(size)), 0, 4))


def _line(one: Standing) -> dict[str, str]:
    place = {}
    if one.position_median_share is not None:
        place = {"position\n‰ median": _two_lines(one.position_median_share, 1e3), "\np95": figure(one.position_p95_share, 1e3)}
    return {
        "method": f"{rank(one):<2} {one.method}",
        "score\n× 1000": _two_lines(one.charge, 1e3),
        "%\nanswered": _two_lines(one.availability, 1e2),
        "rotation\n° median": _two_lines(one.rotation_median_deg),
        " \np95": figure(one.rotation_p95_deg),  # the space tells it from the position's, which is beside it
        **place,
        "%\nwrong": _two_lines(one.wrong, 1e2),
        "CPU ms\na frame": _two_lines(one.cpu_ms),
    }


def _two_lines(estimate: Estimate | None, scale: float = 1.0) -> str:
    return f"{figure(estimate, scale)}\n{interval(estimate, scale)}".rstrip()


def some(names: Sequence[str], most: int = _NAMED) -> str:
    """The first ``most`` names, and how many more there are."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")


def counted(number: int, noun: str) -> str:
    """``1 track``, ``2 tracks``."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
