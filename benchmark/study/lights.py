"""A light's place in a scenario's tree, seen from what it lights."""

from typing import Any

import numpy as np

from benchmark.study.edits import Tree, edited
from scenes.arrays import Floats
from scenes.errors import UsageError, unknown

_INFINITE = ("sun", "earthshine")


def faced(tree: Tree, name: str) -> Floats:
    """(3,) the unit vector to a light, chaser axes: from the target's side, or from where a lamp is aimed."""
    light = _light(tree, name)
    if light["type"] in _INFINITE:
        if isinstance(light["direction"], dict):
            raise UsageError(f"lights.{name}.direction is drawn at random, so it cannot be a factor")
        towards = np.array(light["direction"], dtype=np.float64)
    else:
        towards = _apart(light, name)
    return np.asarray(towards / np.linalg.norm(towards))


def distance_of(tree: Tree, name: str) -> float:
    """Metres from a lamp to where it is aimed."""
    light = _light(tree, name)
    if light["type"] in _INFINITE:
        raise UsageError(f"lights.{name} is a {light['type']} and has no distance")
    return float(np.linalg.norm(_apart(light, name)))


def set_apart(tree: Tree, name: str, towards: Floats, distance_m: float | None = None) -> Tree:
    """``tree`` with the light in another direction; a lamp at ``distance_m`` from where it is aimed, or at the one it had."""
    light = _light(tree, name)
    if light["type"] in _INFINITE:
        return edited(tree, f"lights.{name}.direction", lambda _: towards.tolist())
    length_m = distance_of(tree, name) if distance_m is None else distance_m
    position = np.array(light["aim_m"], dtype=np.float64) + length_m * towards
    return edited(tree, f"lights.{name}.position_m", lambda _: [round(float(one), 9) for one in position])


def _apart(light: dict[str, Any], name: str) -> Floats:
    """(3,) from where a lamp is aimed to where it stands."""
    if light["type"] != "halogen":
        raise UsageError(f"lights.{name} is of type {light['type']!r}, whose place cannot be a factor")
    if light["aim_m"] is None:
        raise UsageError(f"lights.{name}.aim_m: a lamp that is moved about a point needs that point")
    return np.array(light["position_m"], dtype=np.float64) - np.array(light["aim_m"], dtype=np.float64)


def _light(tree: Tree, name: str) -> dict[str, Any]:
    lights = tree["lights"]
    if name not in lights:
        raise UsageError(unknown("light of the scenario", name, lights))
    light: dict[str, Any] = lights[name]
    if light["frame"] != "chaser":
        raise UsageError(f"lights.{name} stands in the axes of the {light['frame']}; a light that is moved stands in the chaser's")
    return light
