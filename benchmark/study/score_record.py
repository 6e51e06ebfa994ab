"""What stands in a study's scores.json: every figure with its interval, so that pages and tables need no frames."""

from typing import Literal

from benchmark.ranking_bootstrap import CONFIDENCE
from benchmark.ranking_record import Estimate
from benchmark.ranking_rule import RESAMPLES, SEED
from benchmark.subjects import Modality
from scenes.spec import Spec, Vector3

AVAILABLE = 0.9
"""The share of right answers below which a method counts as broken."""


class Overall(Spec):
    """A method over all points of the study, each counted once. ``frames``: how many, of all points."""

    modality: Modality
    method: str
    frames: int
    availability: Estimate
    charge: Estimate


class LevelScore(Spec):
    """A method at one level of a factor: over the frames of all ``points`` that have it.

    ``value``: a number in the factor's unit; ``direction``: to the light, a unit vector in the chaser's axes; neither where the
    scenario's own value is no level of the factor. ``availability``: share of right answers; ``charge``: mean over all frames;
    ``rotation_median_deg``: of right answers alone. ``bound_median_rad``: of the information limit of the frames that were asked,
    one that is undetermined above all others; ``bound_determined``: the share of the others. They are the frames', not the
    method's. ``..._change``: paired differences from ``against``, None where there is nothing to compare with.
    """

    modality: Modality
    method: str
    factor: str
    label: str
    value: float | None = None
    direction: Vector3 | None = None
    is_baseline: bool = False
    points: tuple[str, ...]
    frames: int
    availability: Estimate
    charge: Estimate
    rotation_median_deg: Estimate
    bound_median_rad: Estimate
    bound_determined: Estimate
    against: Literal["baseline", "mean"] | None = None
    availability_change: Estimate | None = None
    charge_change: Estimate | None = None


class FactorError(Spec):
    """How much a factor's levels, the baseline left out, cost a method, measured by what they cost the reference.

    ``charge``: mean over the levels. ``reference``: what it is divided by, and ``reference_is`` where that comes from: frozen in
    the study, or the reference method's own in this run; ``ce`` is None where there is none. ``relative_ce``: the same of what
    levels add to the baseline's charge, measured by the reference in this run; None where there is none, or where it is not sure
    that they add anything to the reference's.
    """

    modality: Modality
    method: str
    factor: str
    charge: Estimate
    reference: float | None = None
    reference_is: Literal["frozen", "this run"] | None = None
    ce: Estimate | None = None
    relative_ce: Estimate | None = None


class MeanError(Spec):
    """Means of a method's errors over factors, as ImageNet-C's mCE and relative mCE (Hendrycks & Dietterich 2019), as shares.

    ``factors`` and ``relative_factors``: over which; those whose error is determined. None where there are none.
    """

    modality: Modality
    method: str
    reference_method: str = ""
    factors: tuple[str, ...]
    mce: Estimate | None = None
    relative_factors: tuple[str, ...]
    relative_mce: Estimate | None = None


class Crossing(Spec):
    """``at`` a number in the factor's unit, ``never`` within the range, or ``already`` below where one starts."""

    kind: Literal["at", "never", "already"]
    value: float | None = None


class BreakPoint(Spec):
    """The level at which a method's availability falls below ``AVAILABLE``, going away from ``start``.

    ``start``: the baseline's level, the level nearest to it, or that of the highest availability, as ``start_is`` says.
    ``nearest`` and ``farthest``: the interval, as seen from ``start``; None with too few frames.
    """

    modality: Modality
    method: str
    factor: str
    going: Literal["up", "down"]
    start: float
    start_is: Literal["baseline", "nearest", "best"]
    found: Crossing
    nearest: Crossing | None = None
    farthest: Crossing | None = None


class Index(Spec):
    """A factor's share of the output's variance: alone (``first``), and with all in which it has a part (``total``)."""

    factor: str
    first: Estimate
    total: Estimate


class Sensitivity(Spec):
    """Variance-based indices of the output per point. ``samples``: of the base design that were used.

    ``indices`` is None where the output does not vary, or the design is not whole, as ``lacking`` says.
    """

    modality: Modality
    method: str
    output: Literal["charge", "availability"]
    samples: int
    indices: tuple[Index, ...] | None = None
    lacking: str = ""


class StudyScores(Spec):
    """All of a study's scores. Intervals are those of ``resamples`` paired draws, of indices SALib's."""

    format: Literal["hardlight-study-scores"] = "hardlight-study-scores"
    version: Literal[1] = 1
    confidence: float = CONFIDENCE
    resamples: int = RESAMPLES
    seed: int = SEED
    available: float = AVAILABLE
    overall: tuple[Overall, ...] = ()
    levels: tuple[LevelScore, ...] = ()
    errors: tuple[FactorError, ...] = ()
    means: tuple[MeanError, ...] = ()
    break_points: tuple[BreakPoint, ...] = ()
    sensitivity: tuple[Sensitivity, ...] = ()
