"""Each method at each level of each factor: how often it is right, what that costs, and how well one could have known."""

from typing import Any

import numpy as np

from benchmark.ranking_record import Estimate
from benchmark.study.paired import LevelDraws, Paired, medians
from benchmark.study.score_record import LevelScore, Overall
from scenes.arrays import Bools, Floats


def overall(study: Paired) -> tuple[Overall, ...]:
    """Every method over all points."""
    panel = study.panel
    points = len(panel.points)
    right, charge = (study.means(values.sum(axis=1)) / points for values in (panel.right, panel.charge))
    return tuple(
        Overall(
            modality=panel.modality,
            method=method,
            frames=panel.units * points,
            availability=study.estimate(right[:, place]),
            charge=study.estimate(charge[:, place]),
        )
        for place, method in enumerate(panel.methods)
    )


def level_scores(study: Paired, draws: LevelDraws) -> tuple[LevelScore, ...]:
    """Every method at every level of one factor, level by level."""
    return tuple(
        score
        for level in range(len(draws.levels.values))
        for bounds in [_bounds(study, draws, level)]
        for score in (_score(study, draws, level, method, bounds) for method in range(len(study.panel.methods)))
    )


def _score(study: Paired, draws: LevelDraws, level: int, method: int, bounds: dict[str, Estimate]) -> LevelScore:
    levels, panel = draws.levels, study.panel
    value, columns = levels.values[level], levels.columns[level]
    columns = columns[columns >= 0]
    place: dict[str, Any] = {"direction": value} if isinstance(value, tuple) else {"value": value}
    changes = {"availability_change": draws.availability_change, "charge_change": draws.charge_change}
    return LevelScore(
        modality=panel.modality,
        method=panel.methods[method],
        factor=levels.factor.name,
        label=levels.label(level),
        **place,
        is_baseline=level == levels.baseline,
        points=tuple(panel.points[column] for column in columns),
        frames=panel.units * len(columns),
        availability=study.estimate(draws.availability[:, level, method]),
        charge=study.estimate(draws.charge[:, level, method]),
        rotation_median_deg=study.estimate(medians(study.counts, panel.rotation_deg[:, columns, method])),
        **bounds,
        against=None if draws.charge_change is None else levels.against,
        **{name: None if change is None else study.estimate(change[:, level, method]) for name, change in changes.items()},
    )


def _bounds(study: Paired, draws: LevelDraws, level: int) -> dict[str, Estimate]:
    """Of the information limit at one level: its median, frames where it is undetermined above all others, and their share."""
    columns = draws.levels.columns[level]
    columns = columns[columns >= 0]
    bound_rad, asked = study.panel.bound_rad[:, columns], study.panel.bound_asked[:, columns]
    limits = np.where(asked & np.isnan(bound_rad), np.inf, bound_rad)
    return {
        "bound_median_rad": study.estimate(medians(study.counts, limits)),
        "bound_determined": study.estimate(_share(study, ~np.isnan(bound_rad), asked)),
    }


def _share(study: Paired, part: Bools, whole: Bools) -> Floats:
    """(1 + draws,) how many of ``whole`` are ``part``; NaN in draws that hold none of it."""
    sums = study.means(np.stack([part.sum(axis=1), whole.sum(axis=1)], axis=1).astype(np.float64))
    return np.asarray(np.divide(sums[:, 0], sums[:, 1], out=np.full(len(sums), np.nan), where=sums[:, 1] > 0))
