"""A random field as data: wherever a scenario allows a draw, a plain number is a constant.

Each draw has its own stream per (seed, frame, field path): any frame renders alone and equally, adding a random field changes
no other, and a sweep over one field keeps all else equal.
"""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field, model_validator
from scipy.spatial.transform import Rotation

from scenes.arrays import Floats, unit
from scenes.spec import NonNegative, Positive, Spec, Vector3


class Uniform(Spec):
    """Uniform between ``low`` and ``high``."""

    draw: Literal["uniform"]
    low: float
    high: float

    @model_validator(mode="after")
    def _ordered(self) -> "Uniform":
        if self.high < self.low:
            raise ValueError(f"high {self.high} lies below low {self.low}")
        return self

    def sample(self, rng: np.random.Generator) -> float:
        """One value."""
        return float(rng.uniform(self.low, self.high))


class LogUniform(Spec):
    """Uniform in the logarithm: each octave is equally likely."""

    draw: Literal["log-uniform"]
    low: Positive
    high: Positive

    @model_validator(mode="after")
    def _ordered(self) -> "LogUniform":
        if self.high < self.low:
            raise ValueError(f"high {self.high} lies below low {self.low}")
        return self

    def sample(self, rng: np.random.Generator) -> float:
        """One value."""
        return float(math.exp(rng.uniform(math.log(self.low), math.log(self.high))))


class Normal(Spec):
    """Normal with ``mean`` and standard deviation ``sigma``."""

    draw: Literal["normal"]
    mean: float
    sigma: NonNegative

    def sample(self, rng: np.random.Generator) -> float:
        """One value."""
        return float(rng.normal(self.mean, self.sigma))


def _has_a_direction(vector: Vector3) -> Vector3:
    if not any(vector):
        raise ValueError("a zero vector has no direction")
    return vector


NonZeroVector3 = Annotated[Vector3, AfterValidator(_has_a_direction)]


class OnSphere(Spec):
    """A direction uniform over the cap of half-angle ``within_deg`` about ``about`` (180 = the whole sphere)."""

    draw: Literal["on-sphere"]
    about: NonZeroVector3 = (0.0, 0.0, 1.0)
    within_deg: Annotated[float, Field(ge=0, le=180)] = 180.0

    def sample(self, rng: np.random.Generator) -> Floats:
        """One unit vector (3,)."""
        cos_theta = rng.uniform(math.cos(math.radians(self.within_deg)), 1.0)
        azimuth, sin_theta = rng.uniform(0, 2 * math.pi), math.sqrt(1 - cos_theta**2)
        local = np.array([sin_theta * math.cos(azimuth), sin_theta * math.sin(azimuth), cos_theta])
        to_axis, _ = Rotation.align_vectors(unit(self.about)[None], np.array([[0.0, 0.0, 1.0]]))
        return np.asarray(to_axis.apply(local))


def _only_positive(field: "Scalar") -> "Scalar":
    lowest = lowest_of(field)
    if lowest <= 0:
        raise ValueError(f"must be greater than 0, got values down to {lowest:g}")
    return field


def lowest_of(field: "Scalar") -> float:
    """The least value of a field; a normal draw counts as reaching six sigma (one in 10⁹)."""
    if isinstance(field, Normal):
        return field.mean - 6 * field.sigma
    return field.low if isinstance(field, Uniform | LogUniform) else field


Scalar = float | Annotated[Uniform | LogUniform | Normal, Field(discriminator="draw")]
PositiveScalar = Annotated[Scalar, AfterValidator(_only_positive)]
Direction = NonZeroVector3 | OnSphere


def scalar(field: Scalar, rng: np.random.Generator) -> float:
    """The field's value: itself, or one draw."""
    return field if isinstance(field, float | int) else field.sample(rng)


def direction(field: Direction, rng: np.random.Generator) -> Floats:
    """The field's unit vector (3,): itself scaled to length one, or one draw."""
    return field.sample(rng) if isinstance(field, OnSphere) else unit(field)
