"""Directions to a light as the observer sees them: x right, y down, z from the chaser to the target.

The *phase angle* lies between the ways from the target to the light and to the chaser: 0° behind the camera, 180° past the target.
The *azimuth* is the side: 0° right, 90° below.
"""

import numpy as np

from scenes.arrays import Floats

_GOLDEN = (3 - 5**0.5) / 2  # of a turn
_SIDES = ("right", "below right", "below", "below left", "left", "above left", "above", "above right")


def towards(phase_deg: float, azimuth_deg: float) -> Floats:
    """(3,) the unit vector to a light."""
    phase, azimuth = np.radians(phase_deg), np.radians(azimuth_deg)
    return np.array([np.sin(phase) * np.cos(azimuth), np.sin(phase) * np.sin(azimuth), -np.cos(phase)])


def angles_deg(direction: Floats) -> tuple[float, float]:
    """Phase angle and azimuth of a direction (3,), the latter from 0 up to 360."""
    x, y, z = direction / np.linalg.norm(direction)
    return float(np.degrees(np.arctan2(np.hypot(x, y), -z))), float(np.degrees(np.arctan2(y, x)) % 360)


def side(azimuth_deg: float) -> str:
    """The side in words."""
    return _SIDES[round(azimuth_deg / 45) % 8]


def on_sphere(unit: Floats, phase_deg: tuple[float, float] = (0.0, 180.0)) -> Floats:
    """(n, 3) directions of places (n, 2) of the unit square between two phase angles.

    cos(phase) falls evenly with the first coordinate, the azimuth grows with the second: Archimedes' map, which keeps areas.
    """
    first, last = np.cos(np.radians(phase_deg))
    cosine = np.clip(first + (last - first) * unit[:, 0], -1, 1)
    sine, azimuth = np.sqrt(1 - cosine**2), 2 * np.pi * unit[:, 1]
    return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), -cosine], axis=1)


def equal_area(count: int, phase_deg: tuple[float, float] = (0.0, 180.0)) -> Floats:
    """(count, 3) directions on a spiral that gives each an equal share of the sphere (Swinbank & Purser 2006: Fibonacci grid)."""
    number = np.arange(count)
    return on_sphere(np.stack([(number + 0.5) / count, number * _GOLDEN % 1], axis=1), phase_deg)
