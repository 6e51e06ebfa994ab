"""Without the ring: at least three remembered markers give the ring's frame, not a frame of their own.

The three-marker frame of Shu et al. 2020, eq. (13), begins at a marker; changing to it moves the origin and turns the axes. What
is remembered of the markers in ring coordinates is laid onto what is seen of them (Kabsch 1976), and the ring's frame goes along.
"""

from itertools import combinations

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats


def laid_onto(known_ring: Floats, seen_left: Floats, least_height_m: float, most_residual_m: float) -> RigidTransform | str:
    """left_from_ring by least squares from pairs (n, 3) and (n, 3), metres; or a sentence why they do not give one.

    ``least_height_m``: the smallest height of the best triangle among them: markers on a line leave a turn about it open.
    """
    if len(known_ring) < 3:
        return f"{len(known_ring)} remembered markers are seen, three are needed"
    height = smallest_height(known_ring)
    if height < least_height_m:
        return f"the markers that are seen lie within {height:.2f} m of a line, {least_height_m:.2f} m are needed"
    middle_ring, middle_left = known_ring.mean(axis=0), seen_left.mean(axis=0)
    rotation, _ = Rotation.align_vectors(seen_left - middle_left, known_ring - middle_ring)
    frame = RigidTransform.from_components(middle_left - rotation.apply(middle_ring), rotation)
    residual = float(np.sqrt(np.mean(np.sum((frame.apply(known_ring) - seen_left) ** 2, axis=1))))
    if residual > most_residual_m:
        return f"the markers are {1e3 * residual:.1f} mm from where they are remembered, above {1e3 * most_residual_m:.1f} mm"
    return frame


def smallest_height(points: Floats) -> float:
    """The smallest height of a triangle, for the best of all triangles of points (n ≥ 3, 3)."""
    index = np.array(list(combinations(range(len(points)), 3)))
    a, b, c = (points[index[:, k]] for k in range(3))
    twice_area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    longest = np.max([np.linalg.norm(b - a, axis=1), np.linalg.norm(c - b, axis=1), np.linalg.norm(a - c, axis=1)], axis=0)
    return float(np.max(twice_area / np.maximum(longest, 1e-12)))
