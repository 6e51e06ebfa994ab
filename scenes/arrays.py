"""Read-only arrays, so that values can be shared without fear."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


def frozen(array: ArrayLike, dtype: Any = np.float64) -> NDArray[Any]:
    """A read-only copy of ``array`` with the given dtype (the caller's own array stays writable)."""
    copy = np.array(array, dtype=dtype, copy=True)
    copy.flags.writeable = False
    return copy


def unit(vector: ArrayLike) -> Floats:
    """``vector`` (..., 3) scaled to length one. Raises ``ValueError`` on the zero vector, which has no direction."""
    values = np.asarray(vector, dtype=np.float64)
    length = np.linalg.norm(values, axis=-1, keepdims=True)
    if np.any(length == 0):
        raise ValueError("a zero vector has no direction")
    return np.asarray(values / length)
