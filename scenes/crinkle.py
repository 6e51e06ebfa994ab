"""Crinkled foil as geometry: facets that glint, shade and touch as those of multi-layer insulation do.

A bump map would not do: what breaks detectors are glints of whole facets and the shadows between them.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats, frozen
from scenes.provenance import stream
from scenes.shapes import CrinkledBox

_JITTER = 0.25  # of a grid's step, each way: cells and facets of uneven size, none of them a sliver
_AT_RIM = 0.5  # foil is taped down along edges; more would push them through the first facets beside them


@lru_cache(maxsize=16)
def crinkled_box(shape: CrinkledBox) -> tuple[Floats, NDArray[np.int64]]:
    """Vertices (n, 3) in metres and faces (m, 3), counter-clockwise seen from outside; the same arrays for the same shape.

    Each face is a Delaunay triangulation of a jittered grid, its points moved along the face's normal. Points on an edge
    belong to both faces and are moved along both normals, so the body is closed.
    """
    rim = _rim_points(shape)
    flat, shift, triangles = [rim], [np.zeros_like(rim)], []
    count = len(rim)
    for axis, side in ((axis, side) for axis in range(3) for side in (-1, 1)):
        face = _Face(shape, axis, side)
        on_rim = np.flatnonzero(rim[:, axis] == side * shape.size_m[axis] / 2)
        inner = face.inner_points()
        plane = np.concatenate([rim[on_rim][:, face.in_plane], inner])
        height = face.height(plane)
        shift[0][on_rim, axis] += side * _AT_RIM * height[: len(on_rim)]
        flat.append(face.lifted(inner, np.zeros(len(inner))))
        shift.append(face.lifted(inner, height[len(on_rim) :]) - flat[-1])
        number = np.concatenate([on_rim, count + np.arange(len(inner))])
        triangles.append(number[face.triangles(plane)])
        count += len(inner)
    return frozen(np.concatenate(flat) + np.concatenate(shift)), frozen(np.concatenate(triangles), np.int64)


@dataclass(frozen=True, slots=True)
class _Face:
    """One face of the box: the one at ``side`` (±1) of ``axis``. Its plane's axes follow cyclically: u × v = +axis."""

    shape: CrinkledBox
    axis: int
    side: int

    @property
    def in_plane(self) -> list[int]:
        return [(self.axis + 1) % 3, (self.axis + 2) % 3]

    @property
    def size_m(self) -> Floats:
        return np.array([self.shape.size_m[axis] for axis in self.in_plane])

    def inner_points(self) -> Floats:
        """Corners of the facets inside the face, (n, 2)."""
        return _jittered_grid(self.size_m, self.shape.facet_m, self._rng("facets"))

    def height(self, plane: Floats) -> Floats:
        """How far points (n, 2) of the plane are moved outwards, (n,): bulges between cells, and a crinkle at each point."""
        from scipy.interpolate import LinearNDInterpolator

        rng, cell = self._rng("cells"), self.shape.cell_m
        cells = _jittered_grid(self.size_m + 4 * cell, cell, rng)  # reaches over the rim on all sides
        bulge = LinearNDInterpolator(cells, rng.uniform(-0.5, 0.5, len(cells)))(plane)
        crinkle = self._rng("crinkles").uniform(-0.5, 0.5, len(plane))
        return np.asarray(self.shape.relief_m * bulge + self.shape.fine_relief_m * crinkle)

    def lifted(self, plane: Floats, height: Floats) -> Floats:
        """Points (n, 2) of the plane and their heights (n,) as points (n, 3) of the body."""
        points = np.empty((len(plane), 3))
        points[:, self.in_plane] = plane
        points[:, self.axis] = self.side * (self.shape.size_m[self.axis] / 2 + height)
        return points

    def triangles(self, plane: Floats) -> NDArray[np.int64]:
        """Delaunay triangles (m, 3) of points (n, 2), counter-clockwise seen from outside."""
        from scipy.spatial import Delaunay

        corners = Delaunay(plane).simplices.astype(np.int64)
        a, b, c = (plane[corners[:, one]] for one in range(3))
        area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        clockwise = area * self.side < 0
        corners[clockwise] = corners[clockwise, ::-1]
        return corners

    def _rng(self, what: str) -> np.random.Generator:
        return stream(self.shape.seed, 0, f"crinkled-box.{'-+'[self.side > 0]}{'xyz'[self.axis]}.{what}")


def _rim_points(shape: CrinkledBox) -> Floats:
    """The box's corners and points along its edges, (n, 3), each once."""
    half = np.array(shape.size_m) / 2
    points = [np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T * half]
    rng = stream(shape.seed, 0, "crinkled-box.rim")
    for axis in range(3):
        for first, second in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            along = _jittered_line(shape.size_m[axis], shape.facet_m, rng)
            edge = np.empty((len(along), 3))
            edge[:, axis] = along
            edge[:, (axis + 1) % 3], edge[:, (axis + 2) % 3] = first * half[(axis + 1) % 3], second * half[(axis + 2) % 3]
            points.append(edge)
    return np.concatenate(points)


def _jittered_line(length: float, step: float, rng: np.random.Generator) -> Floats:
    """Points inside (−length/2, length/2) about ``step`` apart."""
    count = int(length / step)
    return np.asarray((np.arange(1, count) + rng.uniform(-_JITTER, _JITTER, count - 1)) * (length / count) - length / 2)


def _jittered_grid(size: Floats, step: float, rng: np.random.Generator) -> Floats:
    """Points (n, 2) in a rectangle about the origin, one in each square of about ``step``, away from its border."""
    counts = (size / step).astype(int)
    places = np.stack(np.meshgrid(*(np.arange(count) + 0.5 for count in counts), indexing="ij"), axis=-1).reshape(-1, 2)
    return np.asarray((places + rng.uniform(-_JITTER, _JITTER, places.shape)) * (size / counts) - size / 2)
