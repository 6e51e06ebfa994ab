"""worst.json: what a search for the worst light tried, and what it found."""

import math
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from benchmark.files import publish, read_record
from benchmark.study.factor import Value
from benchmark.study.score_record import AVAILABLE
from benchmark.study.search_proposals import Sampler
from benchmark.subjects import Modality
from scenes.spec import Spec

FILE = "worst.json"
DARK = 5.0
"""How many times the median bound of the evenly spread points a point's may be; beyond, its light leaves too little for anybody."""


class TrialRecord(Spec):
    """One trial at ``unit`` in the unit cube, where the factors have ``values``. ``value``: what the search went by

    (``benchmark.study.search_cost``); ``charge``: the frames' published mean. ``bound_rotation_rad``: median of the frames that
    were asked, None where none was or it is undetermined; ``is_dark``: it is undetermined, or more than ``DARK`` times the usual.
    ``refused``: why there is no such scenario or picture.
    """

    unit: tuple[float, ...] = ()
    point: str = ""
    label: str = ""
    values: dict[str, Value] = Field(default_factory=dict)
    value: float
    charge: float | None = None
    frames: int = 0
    answered: int = 0
    right: int = 0
    rotation_median_deg: float | None = None
    bound_rotation_rad: float | None = None
    is_dark: bool = False
    refused: str = ""

    @property
    def is_failure(self) -> bool:
        """Whether the method broke here, and the light is none that is left out."""
        return not self.refused and not self.is_dark and self.right < AVAILABLE * self.frames


class WorstBound(Spec):
    """The information limit of the frame that is shown, None where the pose is undetermined."""

    run: str
    frame: int
    sensor: str
    rotation_rad: float | None = None
    position_m: float | None = None


class WorstRecord(Spec):
    """The search of one method. ``trials``: in the order in which they were done, the first ``startup`` spread evenly; ``worst``:
    which of them, None if none counts.

    ``identity``: digest of the study, the method's sources and the libraries, so that another search is not taken for this one.
    """

    format: Literal["hardlight-worst"] = "hardlight-worst"
    version: Literal[1] = 1
    title: str
    method: str
    modality: Modality | None = None
    factors: tuple[str, ...] = ()
    sampler: Sampler
    seed: int
    avoid_dark: bool = False
    command: str = ""
    identity: str
    startup: int = 0
    trials: Annotated[tuple[TrialRecord, ...], Field(min_length=1)]
    worst: int | None
    bound: WorstBound | None = None

    @property
    def is_found(self) -> bool:
        """Whether a light was found that breaks the method."""
        return any(one.is_failure for one in self.trials)

    @property
    def sentence(self) -> str:
        """What was found, as a person reads it."""
        many = f"{len(self.trials)} trial{'' if len(self.trials) == 1 else 's'}"
        if self.worst is None:
            return f"In {many} there was no light under which {self.method} could be asked."
        at = self.trials[self.worst]
        what = f"{at.right} of {at.frames} frames are right, the mean score is {at.charge:.3g}"
        if not self.is_found:
            return f"No failure of {self.method} was found in {many}; the largest score is at {at.label}: {what}."
        failed = sum(one.is_failure for one in self.trials)
        return f"{self.method} fails in {failed} of {many}; the worst is at {at.label}: {what}."

    @property
    def bound_sentence(self) -> str:
        """Whether anybody could have done better there."""
        if self.bound is None:
            return "The bound was not found."
        if self.bound.rotation_rad is None:
            return "The bound is undetermined there: what was seen does not tell the pose, or the rendering's noise hides it."
        sigma_deg = math.degrees(self.bound.rotation_rad)
        return f"The light there leaves the attitude knowable to σ = {sigma_deg:.2g}° (its Cramér-Rao bound)."


def chosen(trials: tuple[TrialRecord, ...]) -> int | None:
    """The place of the worst trial that counts: the largest value, the first of equal ones."""
    counting = [place for place, one in enumerate(trials) if not one.refused and not one.is_dark]
    return max(counting, key=lambda place: trials[place].value, default=None)


def write(folder: Path, found: WorstRecord) -> None:
    """Writes worst.json."""
    publish(folder, {FILE: (found.model_dump_json(indent=1) + "\n").encode()})


def read(folder: Path) -> WorstRecord:
    """The record in ``folder``. Raises ``PredictionsError`` where there is none or the file is damaged."""
    return read_record(folder, FILE, WorstRecord, "run hardlight worst again")
