"""Bodies of revolution: a half section turned about z."""

import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats
from scenes.shapes import Cone, Dish, Lathe, Revolved, Tube

_DISH_STEPS = 32  # from vertex to rim: facets turn by less than 2 deg at any usual focal length


def revolved(shape: Revolved) -> tuple[Floats, NDArray[np.int64]]:
    """Vertices (n, 3) in metres and faces (m, 3), counter-clockwise seen from outside, in the shape's own frame."""
    return turned_about_z(half_section(shape), shape.segments)


def half_section(shape: Revolved) -> Floats:
    """Corners (n, 2) of the closed polygon (r, z) that the shape is the revolution of, metres."""
    match shape:
        case Tube():
            inner, outer, top = shape.inner_radius_m, shape.outer_radius_m, shape.height_m / 2
            return np.array([(inner, -top), (outer, -top), (outer, top), (inner, top)])
        case Cone():
            base, top, half, wall = shape.base_radius_m, shape.top_radius_m, shape.height_m / 2, shape.wall_m
            return np.array([(base - wall, -half), (base, -half), (top, half), (top - wall, half)])
        case Dish():
            radius = np.linspace(0.0, shape.radius_m, _DISH_STEPS + 1)
            hollow = np.column_stack([radius, radius**2 / (4 * shape.focal_length_m)])
            return np.concatenate([hollow - (0.0, shape.wall_m), hollow[::-1]])
        case Lathe():
            return np.array(shape.profile_m)


def turned_about_z(profile: Floats, segments: int) -> tuple[Floats, NDArray[np.int64]]:
    """A closed polygon (n, 2) of (r ≥ 0, z) as triangles: ``segments`` around, first corners in the half plane y = 0, x > 0.

    Corners on the axis become one vertex each, and no triangle is left without an area. The polygon may run either way.
    """
    r, z = profile[:, 0], profile[:, 1]
    if np.sum(r * np.roll(z, -1) - np.roll(r, -1) * z) < 0:
        r, z = r[::-1], z[::-1]  # counter-clockwise in (r, z): what lies to the right of its way is outside
    angle = np.arange(segments) * (2 * np.pi / segments)
    around = np.stack([r[:, None] * np.cos(angle), r[:, None] * np.sin(angle), np.broadcast_to(z[:, None], (len(r), segments))], -1)
    number = np.arange(len(r) * segments).reshape(len(r), segments)
    number[r == 0] = number[r == 0, :1]
    here, there = number, np.roll(number, -1, axis=0)
    quads = np.stack([here, np.roll(here, -1, axis=1), np.roll(there, -1, axis=1), there], axis=-1).reshape(-1, 4)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    used, places = np.unique(faces, return_inverse=True)
    return around.reshape(-1, 3)[used], places.reshape(-1, 3).astype(np.int64)
