"""Which vertex is P1? A rectangle's four cyclic labellings give R·Rx(k·90°) about its normal, and nothing tells k = 2.

So a track holds one k: the label that it was started with. Every frame is compared with the prediction; a labelling
that does not stand out from the next best is refused rather than guessed.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

CYCLIC_LABELLINGS = ((0, 1, 2, 3), (2, 0, 3, 1), (3, 2, 1, 0), (1, 3, 0, 2))
"""Entry k: which seen vertex plays P1..P4, so that the closed form gives R·Rx(k·90°) (Rx passive, as in the paper)."""

_QUARTER_TURNS = Rotation.from_rotvec(-np.pi / 2 * np.arange(4)[:, None] * np.array([1.0, 0.0, 0.0]))


@dataclass(frozen=True, slots=True)
class LabelChoice:
    """``k``: the quarter turns that bring the measurement nearest to the prediction; ``margin_rad`` to the second best."""

    k: int
    angle_rad: float
    margin_rad: float


def quarter_turn(k: int) -> Rotation:
    """Rx(k·90°), passive: the rotation about the feature's normal that relabelling by k multiplies on the right."""
    return _QUARTER_TURNS[k % 4]


def nearest_label(cam_from_feature: Rotation, predicted: Rotation) -> LabelChoice:
    """The k that minimises the geodesic angle between R·Rx(k·90°) and the prediction, and how clear that choice is."""
    angles = np.asarray((predicted.inv() * cam_from_feature * _QUARTER_TURNS).magnitude())
    order = np.argsort(angles)
    return LabelChoice(k=int(order[0]), angle_rad=float(angles[order[0]]), margin_rad=float(angles[order[1]] - angles[order[0]]))
