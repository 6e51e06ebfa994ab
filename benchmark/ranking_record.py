"""What stands in ranking.json: who is ranked where, in what, and how sure that is."""

from typing import Annotated, Literal

from pydantic import Field

from benchmark.ranking_bootstrap import CONFIDENCE
from benchmark.ranking_rule import RESAMPLES, SEED, SENTENCE, UNANSWERED_RAD, UNANSWERED_SHARE
from benchmark.subjects import Modality
from scenes.spec import Spec


class Rule(Spec):
    """How frames are charged and methods ranked, so that the file explains itself."""

    sentence: str = SENTENCE
    unanswered_rad: float = UNANSWERED_RAD
    unanswered_share_of_range: float = UNANSWERED_SHARE
    confidence: float = CONFIDENCE
    resamples: int = RESAMPLES
    seed: int = SEED


class Estimate(Spec):
    """A statistic over all frames with its interval.

    Of a quantile, ``value`` is None where it falls among the frames without an answer, which are larger than any error, and so is a
    bound. Of other statistics both bounds are None where there are too few frames for an interval.
    """

    value: float | None
    low: float | None = None
    high: float | None = None

    @property
    def negative(self) -> "Estimate":
        """That of the same statistic with the other sign."""
        value, low, high = (None if one is None else -one for one in (self.value, self.low, self.high))
        return Estimate(value=value, low=high, high=low)


class Standing(Spec):
    """One method in a division. All is over all ``frames``, answered or not; of ``mono`` nothing is said of positions.

    ``charge``: mean charge, SPEED's score where all is answered. ``wrong``: share of frames with a wrong answer. ``cpu_ms``: per
    frame, None where nothing was timed. ``..._share`` are shares of the range. ``efficiency``: of the frames with an answer and a
    bound, 1 for an ideal estimator that knows these frames alone, 1/4 at twice its spread; None of fewer than 30.
    """

    method: str
    rank: int
    is_tied: bool
    frames: int
    answered: int
    availability: Estimate
    charge: Estimate
    rotation_median_deg: Estimate
    rotation_p95_deg: Estimate
    position_median_m: Estimate | None = None
    position_p95_m: Estimate | None = None
    position_median_share: Estimate | None = None
    position_p95_share: Estimate | None = None
    wrong: Estimate
    cpu_ms: Estimate | None = None
    efficiency: Annotated[Estimate | None, Field(exclude_if=lambda value: value is None)] = None


class Difference(Spec):
    """Mean charge of ``first`` minus that of ``second`` on the same frames; a tie where its interval holds zero, or is lacking."""

    first: str
    second: str
    charge: Estimate

    @property
    def turned(self) -> "Difference":
        """The same pair the other way round."""
        return Difference(first=self.second, second=self.first, charge=self.charge.negative)

    @property
    def better(self) -> str | None:
        """The method that is charged less, by more than chance; None for a tie."""
        if self.charge.low is None or self.charge.high is None or self.charge.low <= 0.0 <= self.charge.high:
            return None
        return self.first if self.charge.high < 0.0 else self.second

    @property
    def worse(self) -> str | None:
        """The other one; None for a tie."""
        return None if self.better is None else {self.first: self.second, self.second: self.first}[self.better]


class Division(Spec):
    """Methods that answered the same tracks, best first, and the difference of each pair."""

    modality: Modality
    cases: tuple[str, ...]
    subjects: tuple[str, ...]
    tracks: int
    frames: int
    methods: tuple[Standing, ...]
    differences: tuple[Difference, ...]


class Ranking(Spec):
    """The divisions of a folder of results: single cameras, then stereo, then LIDARs, those with the most frames first."""

    format: Literal["hardlight-ranking"] = "hardlight-ranking"
    version: Literal[1] = 1
    rule: Rule = Rule()
    divisions: tuple[Division, ...] = ()
