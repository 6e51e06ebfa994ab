"""Named features of a target: the geometry an estimator may be told to look for.

A rectangle's corners are in the order of Zhai et al. 2014, eq. (2): P1, P2 = P1 + L·e1, P3 = P1 + W·e2,
P4 = P1 + L·e1 + W·e2 (Z-order, not cyclic). Seen from outside along −normal with e2 up: P1 bottom left, P2 bottom
right, P3 top left, P4 top right.
"""

from typing import Literal

import numpy as np
from pydantic import model_validator
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats, frozen, unit
from scenes.spec import Fraction, Positive, Spec, Vector3


class RectangleFeature(Spec):
    """A planar rectangle on the target.

    ``centre_m`` in the target frame; ``length_m`` along ``length_axis`` (e1), ``width_m`` along ``width_axis`` (e2); the
    outward normal is e1 × e2. ``gap`` = (from, to) as fractions of the length between which the two long edges do not
    exist (the body between two wings). ``free_standing``: no other part borders it, so outside its edges lies open space.
    """

    type: Literal["rectangle"] = "rectangle"
    name: str
    centre_m: Vector3
    length_m: Positive
    width_m: Positive
    length_axis: Vector3 = (0.0, 1.0, 0.0)
    width_axis: Vector3 = (0.0, 0.0, 1.0)
    gap: tuple[Fraction, Fraction] | None = None
    free_standing: bool = False

    @model_validator(mode="after")
    def _axes_span_a_rectangle(self) -> "RectangleFeature":
        if self.gap is not None and self.gap[0] >= self.gap[1]:
            raise ValueError(f"gap goes from {self.gap[0]} to {self.gap[1]}; the first must be smaller")
        e1, e2 = np.array(self.length_axis), np.array(self.width_axis)
        if not e1.any() or not e2.any():
            raise ValueError(f"length_axis {self.length_axis} and width_axis {self.width_axis} must not be zero")
        cosine = float(unit(e1) @ unit(e2))
        if abs(cosine) > 1e-9:
            raise ValueError(f"length_axis and width_axis must be perpendicular, their cosine is {cosine:.3g}")
        return self

    @property
    def corners_target(self) -> Floats:
        """Corners P1..P4, (4, 3), metres, target frame, Z-order."""
        along, across = unit(self.length_axis) * self.length_m / 2, unit(self.width_axis) * self.width_m / 2
        signs = np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)])
        return frozen(np.asarray(self.centre_m) + signs[:, :1] * along + signs[:, 1:] * across)

    @property
    def target_from_feature(self) -> Rotation:
        """Rotation that takes the paper's rectangle axes (X normal, Y length, Z width) into the target frame."""
        e1, e2 = unit(self.length_axis), unit(self.width_axis)
        return Rotation.from_matrix(np.stack([np.cross(e1, e2), e1, e2], axis=1))


Feature = RectangleFeature  # a tagged union on `type` as soon as there is a second kind
