"""Mass properties of a rigid body, and its inertia as five numbers of which none needs a label.

Free rotation shows an inertia only up to a factor, so J has the trace 3 of the unit sphere's: J = I + Σ jᵢ Eᵢ, with Eᵢ an
orthonormal basis of the traceless symmetric matrices. Principal axes are derived from it and have 24 equally good labellings.
"""

from functools import cache
from itertools import permutations, product

import numpy as np
from numpy.typing import ArrayLike
from pydantic import model_validator
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats, frozen
from scenes.quaternion import Quaternion, rotation
from scenes.spec import Spec, Vector3

_ROUNDING = 1e-9  # of the triangle inequality, relative: a lamina is on its border
_LEAST_MOMENT = 1e-6  # of trace 3, where logarithms are compared

# (5, 3, 3), orthonormal under ⟨A, B⟩ = tr(A B): diag(1, −1, 0)/√2, diag(1, 1, −2)/√6, then the pairs xy, xz, yz.
BASIS: Floats = frozen(
    [
        np.diag([1.0, -1.0, 0.0]) / np.sqrt(2.0),
        np.diag([1.0, 1.0, -2.0]) / np.sqrt(6.0),
        *(np.array([[0, x, y], [x, 0, z], [y, z, 0]]) / np.sqrt(2.0) for x, y, z in np.eye(3)),
    ]
)


class MassProperties(Spec):
    """What a rigid body's free motion depends on.

    ``principal_kg_m2``: moments (Ix, Iy, Iz) about the centre of mass, in any order. ``centre_of_mass_m``: in the target frame,
    as are the principal axes, ``quaternion_wxyz`` = target_from_body.
    """

    principal_kg_m2: Vector3
    centre_of_mass_m: Vector3 = (0.0, 0.0, 0.0)
    quaternion_wxyz: Quaternion = (1.0, 0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _a_body_can_have_it(self) -> "MassProperties":
        if fault := infeasibility(self.principal_kg_m2):
            raise ValueError(f"principal_kg_m2: {fault}")
        return self

    @property
    def target_from_body(self) -> RigidTransform:
        """Takes points from principal axes, origin the centre of mass, into the target frame."""
        return RigidTransform.from_components(self.centre_of_mass_m, rotation(self.quaternion_wxyz))

    @property
    def inertia_target(self) -> Floats:
        """Inertia about the centre of mass in target axes, (3, 3), kg m²."""
        axes = self.target_from_body.rotation.as_matrix()
        return frozen(axes @ np.diag(self.principal_kg_m2) @ axes.T)


def inertia_of(j: ArrayLike) -> Floats:
    """J = I + Σ jᵢ Eᵢ, (..., 3, 3) with trace 3, of its components (..., 5). Nothing says that a body can have it."""
    return np.asarray(np.eye(3) + np.einsum("...i,ijk->...jk", np.asarray(j, dtype=np.float64), BASIS))


def components_of(inertia: ArrayLike) -> Floats:
    """Components (..., 5) of inertias (..., 3, 3) after scaling them to trace 3: jᵢ = tr(Eᵢ J)."""
    matrix = np.asarray(inertia, dtype=np.float64)
    scaled = matrix * (3.0 / np.trace(matrix, axis1=-2, axis2=-1))[..., None, None]
    return np.asarray(np.einsum("ijk,...jk->...i", BASIS, scaled))


def is_feasible(principal: ArrayLike) -> bool:
    """Whether a body can have these principal moments (3,), in any unit."""
    return not infeasibility(principal)


def infeasibility(principal: ArrayLike) -> str:
    """Why no body has these principal moments (3,), as a sentence; empty where one has.

    Each moment is positive and none is more than the sum of the other two (Goldstein, section 5.3); equality is a lamina.
    """
    moments = np.asarray(principal, dtype=np.float64)
    listed = ", ".join(f"{moment:g}" for moment in moments)
    if not (moments > 0).all():
        return f"no body has the principal moments of inertia {listed}: each must be positive"
    most, others = float(moments.max()), float(moments.sum() - moments.max())
    if most > others * (1 + _ROUNDING):
        return f"no body has the principal moments of inertia {listed}: the largest, {most:g}, exceeds the others' sum, {others:g}"
    return ""


def principal_axes(inertia: ArrayLike) -> tuple[Floats, Rotation]:
    """Moments in ascending order (3,) and target_from_body, a proper rotation, of an inertia (3, 3) in target axes."""
    moments, axes = np.linalg.eigh(np.asarray(inertia, dtype=np.float64))
    if np.linalg.det(axes) < 0:
        axes[:, 2] = -axes[:, 2]
    return frozen(moments), Rotation.from_matrix(axes)


@cache
def relabellings() -> Floats:
    """The 24 proper rotations that send axes to axes, (24, 3, 3), the identity first: new_body_from_body."""
    signed = [np.eye(3)[list(order)] * sign for order in permutations(range(3)) for sign in product((1, -1), repeat=3)]
    return frozen([matrix for matrix in signed if np.linalg.det(matrix) > 0])


def labelled_nearest(principal: ArrayLike, target_from_body: Rotation, inertia: ArrayLike) -> tuple[float, float, Rotation]:
    """Ratios p₁ = Iy/Ix, p₂ = Iz/Ix and target_from_body of an estimated ``inertia`` (3, 3), labelled as the truth is.

    Of the 24 labellings it is the one with the least sum of squares of the rotation vector between the axes and of the
    logarithms of the moments' quotients, each at trace 3. ``principal`` (3,) and ``target_from_body``: the truth.
    """
    moments, axes = principal_axes(inertia)
    rotations = axes * Rotation.from_matrix(np.swapaxes(relabellings(), 1, 2))
    labelled = np.abs(relabellings()) @ moments
    true = np.asarray(principal, dtype=np.float64)
    quotients = np.log(_at_trace_3(labelled) / _at_trace_3(true))
    cost = (target_from_body.inv() * rotations).magnitude() ** 2 + (quotients**2).sum(axis=1)
    best = int(np.argmin(cost))
    x, y, z = labelled[best]
    return float(y / x), float(z / x), rotations[best]


def _at_trace_3(moments: Floats) -> Floats:
    return np.asarray(np.maximum(moments * (3.0 / moments.sum(axis=-1, keepdims=True)), _LEAST_MOMENT))
