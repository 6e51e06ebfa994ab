"""Named features of a target: the geometry an estimator may be told to look for.

A rectangle's corners are in the order of Zhai et al. 2014, eq. (2): P1, P2 = P1 + L·e1, P3 = P1 + W·e2,
P4 = P1 + L·e1 + W·e2 (Z-order, not cyclic). Seen from outside along −normal with e2 up: P1 bottom left, P2 bottom
right, P3 top left, P4 top right.
"""

from typing import Annotated, Literal

import numpy as np
from pydantic import Discriminator, Tag, model_validator
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats, frozen, unit
from scenes.spec import Fraction, Positive, Spec, Vector3, kind_of


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


class _OnSurface(Spec):
    """What lies in a plane of the target: ``centre_m``, outward ``normal`` and ``x_axis`` (perpendicular), target frame."""

    name: str
    centre_m: Vector3 = (0.0, 0.0, 0.0)
    normal: Vector3 = (0.0, 0.0, 1.0)
    x_axis: Vector3 = (1.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _axes_are_perpendicular(self) -> "_OnSurface":
        if not any(self.normal) or not any(self.x_axis):
            raise ValueError(f"normal {self.normal} and x_axis {self.x_axis} must not be zero")
        cosine = float(unit(self.normal) @ unit(self.x_axis))
        if abs(cosine) > 1e-9:
            raise ValueError(f"normal and x_axis must be perpendicular, their cosine is {cosine:.3g}")
        return self

    @property
    def target_from_feature(self) -> RigidTransform:
        """Takes points from the feature's frame (origin its centre, Z outward normal, X ``x_axis``) into the target's."""
        z, x = unit(self.normal), unit(self.x_axis)
        rotation = Rotation.from_matrix(np.stack([x, np.cross(z, x), z], axis=1))
        return RigidTransform.from_components(self.centre_m, rotation)


class CircleFeature(_OnSurface):
    """A circular edge: a docking ring's rim. ``x_axis`` points to the marker that tells the rotation about the normal."""

    type: Literal["circle"]
    radius_m: Positive

    def points_target(self, count: int = 360) -> Floats:
        """``count`` points on the circle, (count, 3), metres, target frame, evenly spaced from ``x_axis`` towards Y."""
        angle = np.arange(count) * (2 * np.pi / count)
        circle = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1) * self.radius_m
        return frozen(self.target_from_feature.apply(circle))


class MarkerFeature(_OnSurface):
    """A plane marker: a square of edge or a disc of diameter ``size_m``, ``bright`` on dark ground or dark on bright."""

    type: Literal["marker"]
    shape: Literal["square", "disc"]
    size_m: Positive
    bright: bool = False


Feature = Annotated[
    Annotated[RectangleFeature, Tag("rectangle")]
    | Annotated[CircleFeature, Tag("circle")]
    | Annotated[MarkerFeature, Tag("marker")],
    Discriminator(kind_of("rectangle")),
]
