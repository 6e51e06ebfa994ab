"""What a receiver says of each beam, and what only the simulation knows of it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats
from scenes.beam_fate import BeamFate


@dataclass(frozen=True, slots=True, eq=False)
class Reports:
    """(blocks, beams) each, NaN where there is none; a block is one return of every beam.

    ``measured_m``: the reported range. ``intensity``: the reported strength. ``fate``: a ``BeamFate``. ``source``: the sub-ray
    nearest to the beam's axis that belongs to the return (without one: that meets the target at all), −1 for none.
    ``energy_fraction``: share of the spot on the surface that the return is from. ``electrons``: expected photo-electrons.
    """

    measured_m: Floats
    intensity: Floats
    fate: NDArray[np.uint8]
    source: NDArray[np.int64]
    energy_fraction: Floats
    electrons: Floats

    @classmethod
    def empty(cls, blocks: int, beams: int) -> "Reports":
        """Nothing met, to be filled in."""
        numbers = (np.full((blocks, beams), np.nan) for _ in range(4))
        fate = np.full((blocks, beams), BeamFate.NOTHING, np.uint8)
        measured, intensity, fraction, electrons = numbers
        return cls(measured, intensity, fate, np.full((blocks, beams), -1), fraction, electrons)
