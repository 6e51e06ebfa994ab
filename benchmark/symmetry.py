"""Rotations under which a target or a rectangle looks the same, and which of them a whole track answered with.

An estimate R̂ of the truth R is as good as R̂ = R g for every g of the group. One g is chosen for the whole track: an answer
that hops between equivalent attitudes is not a good answer, so the hops are counted (``label_switches``).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats

GROUPS = ("none", "c2-x", "c2-y", "c2-z", "c4-x", "c4-y", "c4-z", "d2", "octahedral")
_SAME_DIRECTION = 6  # decimals of a unit vector


def group(name: str) -> Rotation:
    """The group ``name`` of ``GROUPS`` as rotations in the target frame; the identity is the first element.

    c2, c4: turns by 180° or 90° about one axis; d2: half turns about all three; octahedral: the 24 rotations of a cube.
    Raises ``ValueError`` for another name.
    """
    if name not in GROUPS:
        raise ValueError(f"no symmetry group is called {name!r}; there are {', '.join(GROUPS)}")
    if name == "octahedral":
        elements: Rotation = Rotation.create_group("O")
        return elements[np.argsort(elements.magnitude(), kind="stable")]
    if name == "d2":
        return Rotation.from_rotvec(np.pi * np.vstack([np.zeros(3), np.eye(3)]))
    order = 1 if name == "none" else int(name[1])
    turns = np.arange(order)[:, None] * (2 * np.pi / order) * np.eye(3)["xyz".index(name[-1]) if order > 1 else 0]
    return Rotation.from_rotvec(turns)


def rectangle_labels(target_from_feature: Rotation) -> Rotation:
    """The four cyclic labellings of a rectangle's corners, as turns k·90° about its normal, in the target frame."""
    return target_from_feature * group("c4-x") * target_from_feature.inv()


def ring_labels(target_from_ring: Rotation, azimuths_rad: Floats) -> Rotation:
    """Turns about a ring's normal by the azimuths (n,) of its markers, in the target frame; the identity is the first element.

    ``target_from_ring`` takes the ring's axes (Z outward normal, X the direction of azimuth 0) into the target frame. A method
    that is not told which marker lies on the X axis may take any of them for it.
    """
    marks = np.exp(1j * np.concatenate([[0.0], azimuths_rad]))
    _, first = np.unique(np.round(marks, _SAME_DIRECTION), return_index=True)
    turns = np.angle(marks[np.sort(first)])[:, None] * np.array([0.0, 0.0, 1.0])
    return target_from_ring * Rotation.from_rotvec(turns) * target_from_ring.inv()


def errors_by_element(truth: Rotation, estimate: Rotation, elements: Rotation) -> Floats:
    """Geodesic angles in radians, (frames, elements), between ``estimate`` and ``truth`` · g for each g of ``elements``."""
    angles = [((truth * element).inv() * estimate).magnitude() for element in elements]
    return np.stack([np.atleast_1d(one) for one in angles], axis=1)


def track_element(truth: Rotation, estimate: Rotation, elements: Rotation) -> int:
    """Index of the element with the smallest sum of geodesic angles over the track (L1, so that outliers do not choose)."""
    return int(np.argmin(errors_by_element(truth, estimate, elements).sum(axis=0)))


def frame_labels(truth: Rotation, estimate: Rotation, elements: Rotation) -> NDArray[np.int64]:
    """(frames,) index of the element nearest to each frame's answer."""
    return np.asarray(np.argmin(errors_by_element(truth, estimate, elements), axis=1), dtype=np.int64)


def label_switches(labels: NDArray[np.int64]) -> int:
    """How often the label changes from one answered frame to the next."""
    return int(np.count_nonzero(np.diff(labels)))
