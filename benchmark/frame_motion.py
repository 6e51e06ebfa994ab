"""From one frame to the next: how the answer moved, how the target did, and the difference.

Shu et al. 2020 report the standard deviation of the relative motion between successive frames. It needs no truth, so it cannot see
what stays the same from frame to frame: an offset of the centre, a wrong ring, a wrong marker; of a slow drift it sees a part in
the number of frames. Where the target's motion is not uniform it counts that motion as noise, hence the difference beside it.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats

AXES = ("x", "y", "z")
KINDS = ("step", "true_step", "step_error")


def names(kind: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The position columns (metres) and the rotation columns (degrees) of one of ``KINDS``."""
    return tuple(f"{kind}_{axis}_m" for axis in AXES), tuple(f"{kind}_r{axis}_deg" for axis in AXES)


def steps(
    count: int, here: NDArray[np.int64], given: tuple[Rotation, Floats], true: tuple[Rotation, Floats]
) -> dict[str, Floats]:
    """Columns of ``count`` frames: the motion from the frame before, NaN where one of the two has no answer.

    ``here`` (k,): the places of the answered frames, ascending. ``given``, ``true``: sensor_from_target rotations and positions
    (k, 3) in metres in the sensor frame. Positions: X(t+1) − X(t). Rotations: dR = R(t)ᵀ R(t+1) as a rotation vector in target
    axes, which unlike differences of Euler angles has no jumps (Shu et al. 2020 use eq. (10)). ``step_error``: the true motion
    taken out, dX − dX_true and dR_trueᵀ dR.
    """
    pairs = np.flatnonzero(np.diff(here) == 1)
    (turned, moved), (truly_turned, truly_moved) = (_between(pairs, *one) for one in (given, true))
    motions = {
        "step": (moved, turned),
        "true_step": (truly_moved, truly_turned),
        "step_error": (moved - truly_moved, truly_turned.inv() * turned),
    }
    columns: dict[str, Floats] = {}
    for kind, (shift_m, turn) in motions.items():
        values = np.full((count, 6), np.nan)
        values[here[pairs + 1]] = np.hstack([shift_m, turn.as_rotvec(degrees=True).reshape(-1, 3)])
        columns |= dict(zip((name for group in names(kind) for name in group), values.T, strict=True))
    return columns


def _between(pairs: NDArray[np.int64], rotation: Rotation, position_m: Floats) -> tuple[Rotation, Floats]:
    """Motion from each of ``pairs`` to the next: the turn in target axes, the shift in the sensor frame."""
    return rotation[pairs].inv() * rotation[pairs + 1], position_m[pairs + 1] - position_m[pairs]
