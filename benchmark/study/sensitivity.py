"""Which factors an output's variance comes from: Sobol' indices, by SALib, of a study in Saltelli's scheme."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from benchmark.ranking_bootstrap import CONFIDENCE
from benchmark.ranking_record import Estimate
from benchmark.ranking_rule import RESAMPLES
from benchmark.study.panel import Panel
from benchmark.study.problem import Dimensioned, problem
from benchmark.study.score_record import Index, Sensitivity
from scenes.arrays import Floats

_ROUNDING = 1e-12  # of an output's size: what sums of equal figures may differ by
_FEWEST = 2  # samples that have a variance


def sensitivities(panel: Panel, factors: Sequence[Dimensioned], points: Sequence[str], seed: int) -> tuple[Sensitivity, ...]:
    """Of every method's mean charge and availability per point. ``points``: in SALib's order, (factors + 2) for each sample.

    A sample of which a point has no frames is left out whole.
    """
    block, column = len(factors) + 2, panel.column
    if len(points) % block:
        rows, lacking = np.zeros(0, dtype=np.int64), f"of {len(points)} points, {block} a sample, some are missing"
    else:
        blocks = np.array([column.get(name, -1) for name in points], dtype=np.int64).reshape(-1, block)
        rows, lacking = blocks[(blocks >= 0).all(axis=1)].ravel(), ""
    return tuple(
        _sensitivity(panel, factors, rows, method, output, lacking, seed)
        for method in range(len(panel.methods))
        for output in ("charge", "availability")
    )


def indices(factors: Sequence[Dimensioned], output: Floats, seed: int) -> tuple[Index, ...] | None:
    """First-order and total indices (Saltelli et al. 2010) of ``output`` (samples · (factors + 2),); None where that does not
    vary among the independent points.

    The variance is that of the two independent samples of each block, which are its first and its last row.
    """
    from SALib.analyze import sobol

    blocks = output.reshape(-1, len(factors) + 2)
    if len(blocks) < _FEWEST or np.ptp(blocks[:, [0, -1]]) <= _ROUNDING * np.abs(output).max():
        return None
    found = sobol.analyze(
        problem(factors),
        output,
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        seed=seed + 1,  # SALib takes 0 for no seed
    )
    return tuple(
        Index(factor=one.name, first=_estimate(found, "S1", place), total=_estimate(found, "ST", place))
        for place, one in enumerate(factors)
    )


def _sensitivity(
    panel: Panel,
    factors: Sequence[Dimensioned],
    rows: NDArray[np.int64],
    method: int,
    output: Literal["charge", "availability"],
    lacking: str,
    seed: int,
) -> Sensitivity:
    samples = len(rows) // (len(factors) + 2)
    values = (panel.charge if output == "charge" else panel.right)[:, :, method].mean(axis=0)
    found = indices(factors, values[rows], seed) if samples >= _FEWEST else None
    if found is None and not lacking:
        lacking = _lack(values[rows], samples)
    return Sensitivity(
        modality=panel.modality, method=panel.methods[method], output=output, samples=samples, indices=found, lacking=lacking
    )


def _lack(output: Floats, samples: int) -> str:
    """Why there are no indices of ``output`` (samples · (factors + 2),)."""
    if samples < _FEWEST:
        return f"{samples} whole samples are too few"
    if np.ptp(output) <= _ROUNDING * np.abs(output).max():
        return "it does not vary"
    return f"it varies too rarely: the {2 * samples} independent points are all alike"


def _estimate(found: dict[str, Floats], name: str, place: int) -> Estimate:
    value, reach = float(found[name][place]), float(found[f"{name}_conf"][place])
    return Estimate(value=value, low=value - reach, high=value + reach)
