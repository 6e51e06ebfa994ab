"""What the seed of a run changes of a motion: without it, another seed is other noise on the same trajectory.

Everything is drawn once a run, from streams of (seed, 0, field): runs of one seed under different lights share a trajectory.
"""

import math
from typing import Annotated

import numpy as np
from pydantic import Field
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats
from scenes.provenance import stream
from scenes.spec import NonNegative, Spec

_ONCE = 0  # the frame of streams that are drawn once a run


class Scatter(Spec):
    """How far a start lies from the stated one.

    ``tilt_deg``: the target's z axis is drawn uniformly from the cap of this half-angle about the stated one. ``roll_deg``: turned
    about z by as much either way. ``position_m``: moved by as much either way along each chaser axis, for the whole run.
    """

    tilt_deg: Annotated[float, Field(ge=0, le=90)] = 0.0
    roll_deg: Annotated[float, Field(ge=0, le=180)] = 0.0
    position_m: tuple[NonNegative, NonNegative, NonNegative] = (0.0, 0.0, 0.0)

    def turn(self, seed: int) -> Rotation:
        """What the start attitude is multiplied with from the right: a tilt about an axis across z, then a roll about z."""
        draw = stream(seed, _ONCE, "motion.scatter.tilt_deg")
        tilt = math.acos(draw.uniform(math.cos(math.radians(self.tilt_deg)), 1.0))
        azimuth = draw.uniform(0.0, 2 * math.pi)
        roll = math.radians(_either_way(self.roll_deg, seed, "roll_deg"))
        across = Rotation.from_rotvec([tilt * math.cos(azimuth), tilt * math.sin(azimuth), 0.0])
        return across * Rotation.from_rotvec([0.0, 0.0, roll])

    def offset_m(self, seed: int) -> Floats:
        """(3,) metres, chaser axes."""
        return np.asarray(stream(seed, _ONCE, "motion.scatter.position_m").uniform(-1.0, 1.0, 3) * self.position_m)


class NutationScatter(Scatter):
    """The same, and where on its cone the target begins: ``phase_deg`` either way."""

    phase_deg: Annotated[float, Field(ge=0, le=180)] = 0.0

    def phase_rad(self, seed: int) -> float:
        """What is added to the stated phase."""
        return math.radians(_either_way(self.phase_deg, seed, "phase_deg"))


def _either_way(most: float, seed: int, field: str) -> float:
    return most * float(stream(seed, _ONCE, f"motion.scatter.{field}").uniform(-1.0, 1.0))
