"""The unit cube of a study's factors as SALib knows it: an axis per dimension, a group per factor."""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from scenes.arrays import Floats


class Dimensioned(Protocol):
    """Anything that is a factor here."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def dimensions(self) -> int:
        """How many axes it takes."""


def problem(factors: Sequence[Dimensioned]) -> dict[str, Any]:
    """SALib's description: a direction's two axes are one group, so that a direction has one index."""
    axes = [(one.name, axis) for one in factors for axis in range(one.dimensions)]
    return {
        "num_vars": len(axes),
        "names": [f"{name}.{axis}" for name, axis in axes],
        "groups": [name for name, _ in axes],
        "bounds": [[0.0, 1.0]] * len(axes),
    }


def samples(factors: Sequence[Dimensioned], base: int, seed: int) -> Floats:
    """(base · (factors + 2), axes) places of the unit cube: Saltelli's scheme on a scrambled Sobol sequence (Saltelli 2002)."""
    import warnings

    from SALib.sample import sobol

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "The balance properties of Sobol")  # of a base that is no power of two: said in the spec
        return np.asarray(sobol.sample(problem(factors), base, calc_second_order=False, seed=seed), dtype=np.float64)
