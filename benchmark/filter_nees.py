"""Whether the errors of a filter are as large as it says: normalised squares and the bounds that chance puts on them.

With errors e drawn from the stated covariance P, eᵀ P⁻¹ e is χ² with as many degrees of freedom as e has components
(Bar-Shalom, Li, Kirubarajan 2001, section 5.4).
"""

import numpy as np
import pandas as pd

from benchmark.filter_states import VECTOR
from scenes.arrays import Floats

DIMENSION = len(VECTOR)
CONFIDENCE = 0.95
_UPPER = tuple((i, j) for i in range(DIMENSION) for j in range(i, DIMENSION))


def covariance(given: pd.DataFrame) -> Floats:
    """(n, 20, 20) the covariances in a method's extras ``cov_i_j``, i ≤ j, counted from 0; NaN where there is none."""
    values = given.reindex(columns=[f"cov_{i}_{j}" for i, j in _UPPER]).to_numpy(dtype=np.float64)
    full = np.empty((len(given), DIMENSION, DIMENSION))
    rows, columns = np.array(_UPPER).T
    full[:, rows, columns] = values
    full[:, columns, rows] = values
    return full


def nees(errors: Floats, given: pd.DataFrame) -> Floats:
    """(n,) normalised squares of ``errors`` (n, 20); NaN where a number is missing or the covariance is not positive."""
    found, stated = np.full(len(errors), np.nan), covariance(given)
    for place in np.flatnonzero(np.isfinite(errors).all(axis=1) & np.isfinite(stated).all(axis=(1, 2))):
        found[place] = _normalised(errors[place], stated[place])
    return found


def _normalised(error: Floats, stated: Floats) -> float:
    """eᵀ P⁻¹ e by Cholesky; the states differ by ten orders of magnitude in their units, so P is scaled to a unit diagonal."""
    scale = np.sqrt(np.maximum(np.diag(stated), 0.0))
    if not (scale > 0).all():
        return float("nan")
    try:
        factor = np.linalg.cholesky(stated / np.outer(scale, scale))
    except np.linalg.LinAlgError:
        return float("nan")
    whitened = np.linalg.solve(factor, error / scale)
    return float(whitened @ whitened)


def mean_bounds(degrees_of_freedom: float, samples: int = 1) -> tuple[float, float]:
    """Between which values 95 % of the means of ``samples`` independent χ² variables lie, of ``degrees_of_freedom`` each."""
    from scipy.stats import chi2

    tail = (1 - CONFIDENCE) / 2
    low, high = (float(chi2.ppf(share, degrees_of_freedom * samples)) / samples for share in (tail, 1 - tail))
    return low, high
