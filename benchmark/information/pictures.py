"""The bound on the pose from one picture: differences of its noise-free signal, weighted with what a digital number tells."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmark.information.digital import DigitalInformation, digital_information
from benchmark.information.fisher import Bound, bound, information, without_nuisance
from scenes.arrays import Floats
from scenes.scenario import Scenario

STEP_PX = 0.15  # largest motion in the picture of one half of a difference
SAMPLES = 64
_SEEDS = (0x1F0A, 0x1F0B)  # of two renderings that share nothing; neither is a data set's own


@dataclass(frozen=True, slots=True, eq=False)
class Derivatives:
    """Two independent estimates ``first``, ``second`` (6, n) of ∂μ/∂ξ, electrons per rad and per metre; ``mean_e`` (n,) between.

    ``render_variance_e2`` (n,): variance that the rendering itself has in one picture of as many samples.
    """

    first: Floats
    second: Floats
    mean_e: Floats
    render_variance_e2: Floats


class PictureInformation:
    """One camera of a scenario."""

    def __init__(self, scenario: Scenario, sensor: str, samples: int = SAMPLES) -> None:
        """Loads the target; a frame then costs 24 pictures."""
        from renderer.neighbours import Neighbours

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
        return Derivatives(first, second, (seen[0] + seen[1]).mean(axis=0) / 2, variance)

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
    ``inflation``: by how much a product of one seed's derivatives with themselves would overstate the information, at worst.
    """

    known: Bound
    rendered: Bound
    gain_and_offset: Bound
    model_5: Bound
    inflation: float


def bounds_of(found: Derivatives, weight: Floats) -> PictureBounds:
    """All variants from one frame's derivatives and weights."""
    known = information(weight, found.first, found.second)
    noisy = 1 / (1 / np.maximum(weight, 1e-30) + found.render_variance_e2)
    vague = 1 / (1 / np.maximum(weight, 1e-30) + (0.05 * found.mean_e) ** 2)
    nuisances = np.vstack([found.mean_e, np.ones_like(found.mean_e)])
    wide = information(weight, np.vstack([found.first, nuisances]), np.vstack([found.second, nuisances]))
    same = (information(weight, one, one) for one in (found.first, found.second))
    diagonal = np.mean([np.diag(one) for one in same], axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        inflation = float(np.max(diagonal / np.diag(known))) if (np.diag(known) > 0).all() else float("nan")
    lit = bool((found.mean_e > 0).any())
    return PictureBounds(
        known=bound(known),
        rendered=bound(information(noisy, found.first, found.second)),
        gain_and_offset=bound(without_nuisance(wide, 6) if lit else known),
        model_5=bound(information(vague, found.first, found.second)),
        inflation=inflation,
    )
