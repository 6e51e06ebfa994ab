"""The bound on the pose from one picture: differences of its noise-free signal, weighted with what a digital number tells."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmark.information import SAMPLES
from benchmark.information.digital import DigitalInformation, digital_information
from benchmark.information.fisher import Bound, bound, information, without_nuisance
from scenes.arrays import Floats
from scenes.scenario import Scenario

STEP_PX = 0.15  # largest motion in the picture of one half of a difference
_SEEDS = (0x1F0A, 0x1F0B)  # of two renderings that share nothing; neither is a data set's own


@dataclass(frozen=True, slots=True, eq=False)
class Derivatives:
    """Two independent estimates ``first``, ``second`` (6, n) of ∂μ/∂ξ, electrons per rad and per metre; ``mean_e`` (n,) between.

    ``render_variance_e2`` (n,): variance that the rendering itself has in one picture of as many samples. ``light``: both
    estimates (2, n) of ∂μ over turns of the key light, electrons per rad, where they were asked for.
    """

    first: Floats
    second: Floats
    mean_e: Floats
    render_variance_e2: Floats
    light: tuple[Floats, Floats] | None = None


class PictureInformation:
    """One camera of a scenario."""

    def __init__(self, scenario: Scenario, sensor: str, samples: int = SAMPLES, light_direction: bool = False) -> None:
        """Loads the target; a frame then costs 24 pictures, and 8 more with ``light_direction``."""
        from renderer.neighbours import Neighbours

        self._light_direction = light_direction
        self._neighbours: Any = Neighbours(scenario, sensor, samples)
        self._detector = scenario.sensors[sensor].detector
        self._tables: dict[float, DigitalInformation] = {}

    def derivatives(self, frame: int, exposure_s: float, step_px: float = STEP_PX) -> Derivatives:
        """Of one frame, both estimates with common random numbers within each difference."""
        half = step_px / self._neighbours.image_motion_px(frame)
        steps = [sign * half[axis] * np.eye(6)[axis] for axis in range(6) for sign in (1, -1)]
        seen = [self._neighbours.electrons(frame, steps, exposure_s, seed).reshape(12, -1) for seed in _SEEDS]
        first, second = ((one[0::2] - one[1::2]) / (2 * half[:, None]) for one in seen)
        variance = ((seen[0] - seen[1]) ** 2).mean(axis=0) / 2
        light = self._of_light(frame, exposure_s, float(half[:3].min())) if self._light_direction else None
        return Derivatives(first, second, (seen[0] + seen[1]).mean(axis=0) / 2, variance, light)

    def _of_light(self, frame: int, exposure_s: float, half_rad: float) -> tuple[Floats, Floats]:
        """Both estimates over the key light's direction: a shadow moves about as the picture does when the target turns."""
        axes = self._neighbours.across_light(frame)
        turns = [sign * half_rad * axis for axis in axes for sign in (1, -1)]
        seen = [self._neighbours.relit_electrons(frame, turns, exposure_s, seed).reshape(4, -1) for seed in _SEEDS]
        first, second = ((one[0::2] - one[1::2]) / (2 * half_rad) for one in seen)
        return first, second

    def weight(self, found: Derivatives, exposure_s: float) -> Floats:
        """(n,) information of each pixel's digital number about its mean, 1/e²."""
        table = self._tables.get(exposure_s)
        if table is None:
            table = self._tables[exposure_s] = digital_information(self._detector, exposure_s)
        return table(found.mean_e)

    def bounds(self, frame: int, exposure_s: float) -> "PictureBounds":
        """The bound of one frame and its variants."""
        found = self.derivatives(frame, exposure_s)
        return bounds_of(found, self.weight(found, exposure_s))


@dataclass(frozen=True, slots=True, eq=False)
class PictureBounds:
    """``known``: everything but the pose is known. The others give up something:

    ``rendered``: the rendering's own noise counts as noise of the picture. ``gain_and_offset``: neither gain nor dark level is
    known. ``model_5``: every pixel's model is off by 5 %, independently (a rough stand-in for errors of shape and materials).
    ``light_direction``: the key light's direction is not known; None where that was not asked for.
    ``inflation``: by how much a product of one seed's derivatives with themselves would overstate the information, at worst.
    """

    known: Bound
    rendered: Bound
    gain_and_offset: Bound
    model_5: Bound
    inflation: float
    light_direction: Bound | None = None

    @property
    def taken(self) -> Bound:
        """``known``, or ``rendered`` where the rendering's noise hides whether it is determined.

        Every pixel counts less in ``rendered``, so it is nowhere below ``known`` but for noise, of which it has less.
        """
        return self.known if self.known.is_determined else self.rendered


def bounds_of(found: Derivatives, weight: Floats) -> PictureBounds:
    """All variants from one frame's derivatives and weights."""
    known = information(weight, found.first, found.second)
    noisy = 1 / (1 / np.maximum(weight, 1e-30) + found.render_variance_e2)
    vague = 1 / (1 / np.maximum(weight, 1e-30) + (0.05 * found.mean_e) ** 2)
    lit = bool((found.mean_e > 0).any())
    nuisances = np.vstack([found.mean_e, np.ones_like(found.mean_e)])
    same = (information(weight, one, one) for one in (found.first, found.second))
    diagonal = np.mean([np.diag(one) for one in same], axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        inflation = float(np.max(diagonal / np.diag(known))) if (np.diag(known) > 0).all() else float("nan")
    return PictureBounds(
        known=bound(known),
        rendered=bound(information(noisy, found.first, found.second)),
        gain_and_offset=_unknown(found, weight, nuisances, nuisances) if lit else bound(known),
        model_5=bound(information(vague, found.first, found.second)),
        inflation=inflation,
        light_direction=None if found.light is None else _unknown(found, weight, *found.light),
    )


def _unknown(found: Derivatives, weight: Floats, first: Floats, second: Floats) -> Bound:
    """The bound where nuisances are not known, of whose derivatives (k, n) there are two estimates, too."""
    wide = information(weight, np.vstack([found.first, first]), np.vstack([found.second, second]))
    if np.linalg.eigvalsh(wide[6:, 6:])[0] <= 0:
        return bound(np.full((6, 6), np.nan))
    return bound(without_nuisance(wide, 6))
