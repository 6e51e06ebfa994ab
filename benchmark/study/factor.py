"""What a study varies: numbers of the scenario, the direction of a light on the sphere, along an arc, or its distance."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from benchmark.study import directions
from benchmark.study.collisions import path_twice
from benchmark.study.edits import Tree, edited, found, times
from benchmark.study.lights import distance_of, faced, set_apart
from scenes.arrays import Floats
from scenes.errors import UsageError
from scenes.spec import Spec, kind_of

Value = float | tuple[float, float, float]
"""A level: a number in the factor's unit, or a direction to the light, a unit vector in the chaser's axes."""
Scale = Literal["linear", "log"]


def _ends(ends: tuple[float, float]) -> tuple[float, float]:
    if not ends[0] < ends[1]:
        raise ValueError(f"range goes from its lower end to its upper one, not from {ends[0]:g} to {ends[1]:g}")
    return ends


Ends = Annotated[tuple[float, float], AfterValidator(_ends)]


class _Ordered(Spec):
    """A factor whose levels are numbers: ``levels`` as they stand, or ``steps`` of them across ``range``."""

    title: str
    unit: str = ""
    levels: tuple[float, ...] = ()
    range: Ends | None = None
    steps: Annotated[int, Field(ge=2, le=1000)] = 5
    scale: Scale = "linear"

    @model_validator(mode="after")
    def _has_levels(self) -> "_Ordered":
        if not self.levels and self.range is None:
            raise ValueError("a factor has levels = [...], or a range = [low, high]")
        if len(set(self.levels)) < len(self.levels):
            raise ValueError("levels: one is there twice")
        lowest = min(*self.ends, *self.levels)
        if self.scale == "log" and lowest <= 0:
            raise ValueError(f"scale = 'log' needs numbers above zero, and the lowest is {lowest:g}")
        return self

    @property
    def dimensions(self) -> int:
        """How many numbers of the unit cube it takes."""
        return 1

    @property
    def ends(self) -> tuple[float, float]:
        """Between which numbers it lies."""
        return self.range or (min(self.levels), max(self.levels))

    @property
    def values(self) -> tuple[Value, ...]:
        """The levels in rising order."""
        if self.levels:
            return tuple(sorted(self.levels))
        return tuple(self.at(np.array([share])) for share in np.linspace(0, 1, self.steps))

    def at(self, unit: Floats) -> Value:
        """The number at a share (1,) of the way from the lower end to the upper one."""
        low, high = self.ends
        share = float(unit[0])
        return float(f"{low * (high / low) ** share if self.scale == 'log' else low + (high - low) * share:.6g}")

    def label(self, value: Value) -> str:
        """A level as a person reads it."""
        assert isinstance(value, float | int)
        return f"{value:.4g}{'' if self.unit in ('', '×', '°') else ' '}{self.unit}"


class NumberFactor(_Ordered):
    """Numbers of the scenario at ``paths`` (``benchmark.study.edits``), ``set`` to a level or multiplied by it (``times``)."""

    type: Literal["number"] = "number"
    paths: Annotated[tuple[str, ...], Field(min_length=1)]
    how: Literal["set", "times"] = "set"

    @property
    def light(self) -> str:
        """No light's place."""
        return ""

    def baseline(self, tree: Tree) -> Value | None:
        """What the scenario has: the one number at all paths, or 1 of what is multiplied; None where there is no one number."""
        if self.how == "times":
            return 1.0
        values = [value for path in self.paths for value in found(tree, path)]
        if any(isinstance(value, bool) or not isinstance(value, float | int) for value in values):
            return None
        return float(values[0]) if len(set(values)) == 1 else None

    def applied(self, tree: Tree, value: Value) -> Tree:
        """``tree`` at a level."""
        assert isinstance(value, float | int)
        for path in self.paths:
            tree = edited(tree, path, times(value) if self.how == "times" else lambda _: value)
        return tree


class ArcFactor(_Ordered):
    """A light's phase angle in degrees: between the ways from the target to the light and to the chaser.

    ``azimuth_deg`` says on which side: 0 to the right of the line of sight, 90 below it; left out, the side where it stands.
    A lamp keeps its distance from where it is aimed.
    """

    type: Literal["arc"]
    light: str
    unit: str = "°"
    azimuth_deg: float | None = None

    def baseline(self, tree: Tree) -> Value | None:
        """The phase angle in the scenario, None where the light stands off the arc."""
        phase_deg, azimuth_deg = directions.angles_deg(faced(tree, self.light))
        off = 0.0 if self.azimuth_deg is None else (azimuth_deg - self.azimuth_deg + 180) % 360 - 180
        return round(phase_deg, 6) if abs(off) < 1e-6 else None

    def applied(self, tree: Tree, value: Value) -> Tree:
        """``tree`` at a level."""
        assert isinstance(value, float | int)
        azimuth_deg = directions.angles_deg(faced(tree, self.light))[1] if self.azimuth_deg is None else self.azimuth_deg
        return set_apart(tree, self.light, directions.towards(value, azimuth_deg))


class DistanceFactor(_Ordered):
    """Metres between a lamp and where it is aimed, in the direction in which it stands."""

    type: Literal["distance"]
    light: str
    unit: str = "m"

    @model_validator(mode="after")
    def _is_away_from_there(self) -> "DistanceFactor":
        if (lowest := min(*self.ends, *self.levels)) <= 0:
            raise ValueError(f"a distance is above zero, and the lowest is {lowest:g}")
        return self

    def baseline(self, tree: Tree) -> Value | None:
        """The distance in the scenario."""
        return round(distance_of(tree, self.light), 6)

    def applied(self, tree: Tree, value: Value) -> Tree:
        """``tree`` at a level."""
        assert isinstance(value, float | int)
        return set_apart(tree, self.light, faced(tree, self.light), value)


class DirectionFactor(Spec):
    """Where on the sphere a light stands: ``count`` directions that each stand for an equal share of it.

    ``phase_deg``: only those between two phase angles.
    """

    type: Literal["direction"]
    title: str
    light: str
    count: Annotated[int, Field(ge=2, le=100_000)] = 64
    phase_deg: Ends = (0.0, 180.0)

    @property
    def unit(self) -> str:
        """None."""
        return ""

    @property
    def scale(self) -> Scale:
        """Directions have none; equal areas are equal shares."""
        return "linear"

    @property
    def dimensions(self) -> int:
        """How many numbers of the unit cube it takes."""
        return 2

    @property
    def values(self) -> tuple[Value, ...]:
        """The directions, from the observer's side to behind the target."""
        return tuple(_rounded(one) for one in directions.equal_area(self.count, self.phase_deg))

    def at(self, unit: Floats) -> Value:
        """The direction at a place (2,) of the unit square, of which equal areas are equal areas of the sphere."""
        return _rounded(directions.on_sphere(unit[None], self.phase_deg)[0])

    def label(self, value: Value) -> str:
        """A direction as a person reads it."""
        assert isinstance(value, tuple)
        phase_deg, azimuth_deg = directions.angles_deg(np.array(value))
        return f"phase {phase_deg:.0f}°, {directions.side(azimuth_deg)}" if 0.5 < phase_deg < 179.5 else f"phase {phase_deg:.0f}°"

    def baseline(self, tree: Tree) -> Value | None:
        """The direction in the scenario."""
        return _rounded(faced(tree, self.light))

    def applied(self, tree: Tree, value: Value) -> Tree:
        """``tree`` at a level."""
        assert isinstance(value, tuple)
        return set_apart(tree, self.light, np.array(value))


Factor = Annotated[
    Annotated[NumberFactor, Tag("number")]
    | Annotated[ArcFactor, Tag("arc")]
    | Annotated[DistanceFactor, Tag("distance")]
    | Annotated[DirectionFactor, Tag("direction")],
    Discriminator(kind_of("number")),
]


def _rounded(direction: Floats) -> tuple[float, float, float]:
    """Few digits, so that a scenario's digest does not hang on the last bits of a sine."""
    x, y, z = (round(float(one), 9) + 0.0 for one in direction)
    return x, y, z


def refused(factor: Any, name: str, tree: Tree) -> str | None:
    """Why a factor cannot be applied to a scenario; None where it can."""
    try:
        for value in factor.values:
            factor.applied(tree, value)
        factor.baseline(tree)
    except UsageError as error:
        return f"factors.{name}: {error}"
    if (path := path_twice(factor, tree)) is not None:
        return f"factors.{name}.paths: {path!r} leads to what another of the paths changes already"
    return None
