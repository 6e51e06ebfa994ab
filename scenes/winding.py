"""Which side of a mesh is its outside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats


def outward(vertices: Floats, faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """``faces`` (m, 3) with every closed body counter-clockwise seen from outside, in their order.

    A body (triangles that share edges, vertices at the same place counting as one) whose edges are all run through once in
    each direction encloses the volume Σ a·(b × c) / 6 (divergence theorem); where that is negative its triangles are turned
    over. Open surfaces, and bodies whose triangles disagree with each other, have no outside to go by: they stay.
    """
    import trimesh

    places, place = np.unique(vertices, axis=0, return_inverse=True)
    corners = place.reshape(-1)[faces]
    whole = np.flatnonzero((corners != np.roll(corners, 1, axis=1)).all(axis=1))
    if len(whole) == 0:
        return faces
    centred = places - places.mean(axis=0)  # far from the origin a small volume would drown in rounding
    mesh = trimesh.Trimesh(centred, corners[whole], process=False)
    trimesh.repair.fix_inversion(mesh, multibody=True)
    turned = whole[(np.asarray(mesh.faces) != corners[whole]).any(axis=1)]
    result = faces.copy()
    result[turned] = faces[turned, ::-1]
    return result
