"""The columns of bounds.parquet that hold a bound, and the way back from them."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from benchmark.information.fisher import AXES, Bound
from scenes.arrays import Floats

UPPER = tuple(zip(*np.triu_indices(6)))


def columns_of(found: Bound) -> Iterator[tuple[str, float]]:
    """``information_<a>_<b>`` (the upper triangle), ``sigma_<a>``, ``sigma_rotation_rad``, ``sigma_position_m``; rad and m."""
    for row, column in UPPER:
        yield f"information_{AXES[row]}_{AXES[column]}", float(found.information[row, column])
    for axis, sigma in zip(AXES, found.sigma, strict=True):
        yield f"sigma_{axis}", float(sigma)
    yield "sigma_rotation_rad", found.rotation_rad
    yield "sigma_position_m", found.position_m


def informations(table: pd.DataFrame) -> Floats:
    """(n, 6, 6) information matrices of a table's rows."""
    full = np.zeros((len(table), 6, 6))
    for row, column in UPPER:
        full[:, row, column] = full[:, column, row] = table[f"information_{AXES[row]}_{AXES[column]}"]
    return full
