"""One number for a method, after ImageNet-C (Hendrycks & Dietterich 2019): what levels cost it, by what they cost a reference.

CE of a factor is Σ over its levels of the method's mean charge / Σ of the reference's, mCE its mean over factors. The relative CE
takes what each level adds to the baseline's charge instead. The baseline itself is no level here, as clean pictures are not there.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from benchmark.ranking_bootstrap import SHORTEST, bounds
from benchmark.study.paired import LevelDraws, Paired
from benchmark.study.record import StudyRecord
from benchmark.study.score_record import FactorError, MeanError
from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class _Errors:
    """Of one factor (1 + draws, methods): the mean charge, CE and relative CE; None where undetermined."""

    factor: str
    charge: Floats
    reference: float | None
    reference_is: Literal["frozen", "this run"] | None
    ce: Floats | None
    relative: Floats | None


def aggregated(
    study: Paired, factors: Sequence[LevelDraws], record: StudyRecord
) -> tuple[tuple[FactorError, ...], tuple[MeanError, ...]]:
    """Every method's error per factor, and their means over factors."""
    errors = [found for draws in factors if (found := _errors(study, draws, record)) is not None]
    methods = range(len(study.panel.methods)) if errors else ()
    return (
        tuple(_of_factor(study, one, method) for one in errors for method in methods),
        tuple(_of_all(study, errors, method, record) for method in methods),
    )


def _errors(study: Paired, draws: LevelDraws, record: StudyRecord) -> _Errors | None:
    """None of a factor whose only level is the baseline."""
    modality, levels = study.panel.modality, draws.levels
    if not len(levels.off_baseline):
        return None
    charge = draws.charge[:, levels.off_baseline].mean(axis=1)
    own = _column(study, record, charge)
    frozen = record.frozen.get(modality, {}).get(levels.factor.name)
    reference = own if frozen is None else np.full(len(charge), frozen)
    relative = None
    if levels.baseline is not None:
        added = (draws.charge[:, levels.off_baseline] - draws.charge[:, levels.baseline, None]).mean(axis=1)
        least = _column(study, record, added)
        relative = _ratio(added, least) if least is not None and _surely_positive(study, least) else None
    return _Errors(
        levels.factor.name,
        charge,
        None if reference is None else float(reference[0]),
        None if reference is None else "this run" if frozen is None else "frozen",
        _ratio(charge, reference),
        relative,
    )


def _column(study: Paired, record: StudyRecord, values: Floats) -> Floats | None:
    """(1 + draws,) the reference method's own; None where it is not in this run."""
    name, methods = record.references.get(study.panel.modality), study.panel.methods
    return values[:, methods.index(name)] if name in methods else None


def _ratio(values: Floats, reference: Floats | None) -> Floats | None:
    """(1 + draws, methods); None without a reference or of one that costs nothing, NaN in draws where it costs nothing."""
    if reference is None or reference[0] <= 0:
        return None
    by = reference[:, None]
    return np.asarray(np.divide(values, by, out=np.full(values.shape, np.nan), where=by > 0))


def _surely_positive(study: Paired, added: Floats) -> bool:
    """Whether a ratio to ``added`` means something: its interval lies above zero."""
    return bool(added[0] > 0 and (study.panel.units < SHORTEST or bounds(added[1:])[0] > 0))


def _of_factor(study: Paired, errors: _Errors, method: int) -> FactorError:
    return FactorError(
        modality=study.panel.modality,
        method=study.panel.methods[method],
        factor=errors.factor,
        charge=study.estimate(errors.charge[:, method]),
        reference=errors.reference,
        reference_is=errors.reference_is,
        ce=None if errors.ce is None else study.estimate(errors.ce[:, method]),
        relative_ce=None if errors.relative is None else study.estimate(errors.relative[:, method]),
    )


def _of_all(study: Paired, errors: Sequence[_Errors], method: int, record: StudyRecord) -> MeanError:
    plain = {one.factor: one.ce[:, method] for one in errors if one.ce is not None}
    relative = {one.factor: one.relative[:, method] for one in errors if one.relative is not None}
    return MeanError(
        modality=study.panel.modality,
        method=study.panel.methods[method],
        reference_method=record.references.get(study.panel.modality, ""),
        factors=tuple(plain),
        mce=study.estimate(np.mean(list(plain.values()), axis=0)) if plain else None,
        relative_factors=tuple(relative),
        relative_mce=study.estimate(np.mean(list(relative.values()), axis=0)) if relative else None,
    )
