"""A study's scores as texts: the tables that the console prints, each with its title."""

from collections.abc import Iterator, Sequence
from math import pi

from benchmark.ranking_cells import figure, interval, short
from benchmark.ranking_record import Estimate
from benchmark.study.score_record import BreakPoint, Crossing, FactorError, LevelScore, StudyScores
from benchmark.subjects import NAMES

Rows = list[dict[str, str]]
_DEG = 180 / pi
MOST = 12
"""Levels of a factor that are printed one by one; of more, as of a sphere, the hardest alone."""


def tables(found: StudyScores) -> list[tuple[str, Rows]]:
    """Each modality's methods, then what factors do to them, level by level, then where the variance comes from."""
    return [(title, rows) for modality in NAMES for title, rows in _of_modality(_only(found, modality)) if rows]


def change(estimate: Estimate | None, scale: float = 1.0) -> str:
    """A difference with its sign and its interval; empty where there is none."""
    if estimate is None or estimate.value is None:
        return ""
    between = ""
    if estimate.low is not None and estimate.high is not None and estimate.low != estimate.high:
        between = f" ({_signed(scale * estimate.low)} to {_signed(scale * estimate.high)})"
    return f"{_signed(scale * estimate.value)}{between}"


def broken(one: BreakPoint) -> str:
    """Where a method breaks, with the interval as seen from the start."""
    ends = "" if one.nearest is None or one.farthest is None else f"{_reached(one.nearest)} to {_reached(one.farthest)}"
    is_sure = one.nearest == one.found == one.farthest
    return _reached(one.found) + (f" ({ends})" if ends and not is_sure else "")


def _only(found: StudyScores, modality: str) -> StudyScores:
    fields = ("overall", "levels", "errors", "means", "break_points", "sensitivity")
    return found.model_copy(
        update={field: tuple(one for one in getattr(found, field) if one.modality == modality) for field in fields}
    )


def _of_modality(found: StudyScores) -> Iterator[tuple[str, Rows]]:
    if not found.overall:
        return
    heading = NAMES[found.overall[0].modality]
    yield f"{heading}: all points", _methods(found)
    yield f"{heading}: factors", _factors(found)
    for factor in dict.fromkeys(score.factor for score in found.levels):
        levels = [score for score in found.levels if score.factor == factor]
        is_long = len({score.label for score in levels}) > MOST or levels[0].direction is not None
        yield f"{heading}: {factor}{', hardest level' if is_long else ''}", _levels(_hardest(levels) if is_long else levels)
    yield f"{heading}: share of the variance that each factor has alone, and in all", _indices(found)


def _methods(found: StudyScores) -> Rows:
    """A line per method."""
    means = {one.method: one for one in found.means}
    rows = []
    for one in found.overall:
        row = {"method": one.method, "score\n× 1000": _lines(one.charge, 1e3), "%\nright": _lines(one.availability, 1e2)}
        if one.method in means:
            mean = means[one.method]
            row |= {"mCE\n%": _lines(mean.mce, 1e2), "relative\nmCE %": _lines(mean.relative_mce, 1e2)}
        rows.append(row)
    return rows


def _factors(found: StudyScores) -> Rows:
    """A line per factor and method: its error, and where it breaks."""
    return [_factor(found, one) for one in found.errors]


def _factor(found: StudyScores, one: FactorError) -> dict[str, str]:
    breaks = {point.going: point for point in found.break_points if (point.method, point.factor) == (one.method, one.factor)}
    return {
        "factor": one.factor,
        "method": one.method,
        "score\n× 1000": _lines(one.charge, 1e3),
        "CE %": _lines(one.ce, 1e2),
        "relative\nCE %": _lines(one.relative_ce, 1e2),
        **{
            f"below {found.available:.0%}\ngoing {going}": broken(breaks[going]) if going in breaks else "—"
            for going in ("up", "down")
        },
    }


def _hardest(levels: Sequence[LevelScore]) -> list[LevelScore]:
    """Each method's level with the largest mean charge."""
    best: dict[str, LevelScore] = {}
    for one in levels:
        if one.method not in best or _charge(one) > _charge(best[one.method]):
            best[one.method] = one
    return list(best.values())


def _charge(one: LevelScore) -> float:
    return one.charge.value or 0.0


def _levels(levels: Sequence[LevelScore]) -> Rows:
    """A line per level and method."""
    return [
        {
            "level": f"{one.label}{' (baseline)' if one.is_baseline else ''}",
            "method": one.method,
            "score\n× 1000": _lines(one.charge, 1e3),
            f"from the\n{one.against or 'mean'}": change(one.charge_change, 1e3),
            "%\nright": _lines(one.availability, 1e2),
            "rotation\n° median": _lines(one.rotation_median_deg),
            "bound\n° median": _lines(one.bound_median_rad, _DEG),
            "bound\n% known": figure(one.bound_determined, 1e2),
        }
        for one in levels
    ]


def _indices(found: StudyScores) -> Rows:
    """A line per method, output and factor."""
    rows = []
    for one in found.sensitivity:
        output = {"charge": "score", "availability": "share right"}[one.output]
        for index in one.indices or ():
            alone, total = _lines(index.first), _lines(index.total)
            rows.append({"method": one.method, "of the": output, "factor": index.factor, "alone": alone, "in all": total})
        if one.indices is None:
            rows.append({"method": one.method, "of the": output, "factor": one.lacking, "alone": "—", "in all": "—"})
    return rows


def _lines(estimate: Estimate | None, scale: float = 1.0) -> str:
    """The figure, and its interval on a second line."""
    return f"{figure(estimate, scale)}\n{interval(estimate, scale)}".rstrip()


def _signed(value: float) -> str:
    return f"{'+' if value > 0 else '−' if value < 0 else ''}{short(abs(value))}"


def _reached(one: Crossing) -> str:
    return one.kind if one.value is None else f"{one.value:.4g}"
