"""Lumps of rock: a sphere's points moved along their radii by a random field."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from scenes.arrays import Floats, frozen
from scenes.provenance import stream
from scenes.shapes import Rubble

_WAVES = 24  # of each octave: enough that none can be told
_LONGEST = 2.0  # radians of phase over a radius in the first octave: lumps of the body's own size
_FALL = 0.42  # of the amplitude from octave to octave


@lru_cache(maxsize=16)
def rubble(shape: Rubble) -> tuple[Floats, NDArray[np.int64]]:
    """Vertices (n, 3) in metres and faces (m, 3), counter-clockwise seen from outside; the same arrays for the same shape.

    Each radius keeps its direction, so the surface is closed and meets no ray from the origin twice.
    """
    from trimesh import creation

    sphere = creation.icosphere(subdivisions=shape.subdivisions, radius=1.0)
    directions = np.asarray(sphere.vertices)
    stretch = np.exp(shape.relief * _field(directions, shape))
    vertices = directions * (np.array(shape.size_m) / 2) * stretch[:, None]
    return frozen(vertices), frozen(sphere.faces, np.int64)


def _field(directions: Floats, shape: Rubble) -> Floats:
    """A smooth random field over the unit sphere, (n,), of mean 0 and rms 1 over its points: octaves of plane waves."""
    total = np.zeros(len(directions))
    for octave in range(shape.octaves):
        rng = stream(shape.seed, 0, f"rubble.octave-{octave}")
        waves = rng.standard_normal((_WAVES, 3)) * (_LONGEST * 2**octave / np.sqrt(3))
        phases = rng.uniform(0, 2 * np.pi, _WAVES)
        total += _FALL**octave * np.cos(directions @ waves.T + phases).sum(axis=1)
    total -= total.mean()
    return np.asarray(total / np.sqrt(np.mean(total**2)))
