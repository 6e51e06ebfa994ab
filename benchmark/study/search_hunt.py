"""What is searched for the worst light, and how: a study with one method alone."""

from dataclasses import dataclass
from typing import Any

from benchmark.methods import source_digest
from benchmark.study.collisions import lost
from benchmark.study.search_proposals import Axis, Sampler
from benchmark.study.spec import Study, case_of
from benchmark.subjects import Modality
from benchmark.suite import Method
from scenes.dataset_range import parse_frames
from scenes.errors import UsageError, unknown
from scenes.provenance import sha256_of_json, software_versions


@dataclass(frozen=True, slots=True, eq=False)
class Hunt:
    """What is searched: ``study`` with one method alone (``narrowed``), and how. ``avoid_dark``: see ``narrowed``."""

    study: Study
    method: str
    modality: Modality | None
    trials: int
    seed: int
    sampler: Sampler
    avoid_dark: bool

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The unit cube's: a direction is a line (its cosine) and a circle (its azimuth)."""
        found: list[Axis] = []
        for one in self.study.factors.values():
            found += ["line", "circle"] if one.dimensions == 2 else ["line"]
        return tuple(found)

    @property
    def identity(self) -> str:
        """Digest of all that a trial's value follows from."""
        source = source_digest(self.study.methods[self.method].estimator)
        return sha256_of_json([self.study.model_dump(mode="json"), source, software_versions(), self.avoid_dark])


def narrowed(study: Study, method: str, modality: Modality | None, avoid_dark: bool) -> Study:
    """``study`` with this method alone and what it answers, without bounds unless dark lights are to be left out.

    Raises ``UsageError``.
    """
    if method not in study.methods:
        raise UsageError(unknown("method of this study", method, study.methods))
    one = study.methods[method]
    if modality is not None:
        if one.modality not in (None, modality):
            raise UsageError(f"--modality {modality}: {method} is a method for {one.modality}")
        one = one.model_copy(update={"modality": modality})
    if study.design == "one-at-a-time" and (faults := lost(study.factors, study.scenario.model_dump(mode="json"))):
        raise UsageError(f"a search combines the factors that the study takes one at a time: {'; '.join(faults)}")
    alone = {"methods": {method: one}, "references": {}, "frozen": {}} | _asked(study, one)
    design = "sphere" if study.design == "sphere" else "factorial"  # what is tried is no Sobol design
    bounds = (study.bound_frames or _last(study)) if avoid_dark else None
    return study.model_copy(update={**alone, "design": design, "bound_frames": bounds})


def _asked(study: Study, one: Method) -> dict[str, Any]:
    """Of what ``study`` asks for that which the method answers: the others' frames are no part of the search."""
    subjects = [subject for subject in case_of(study, "p", "", study.scenario).subjects if one.answers(subject)]
    if not subjects:
        raise UsageError(f"the study asks for nothing that a method for {one.modality} answers")
    features = tuple(subject.feature for subject in subjects if subject.feature is not None)
    return {"features": features, "lidar": next((subject.lidar for subject in subjects if subject.lidar is not None), None)}


def _last(study: Study) -> str:
    """The last of its frames, by place: the first ones may be a filter's to settle in."""
    return str(len(parse_frames(study.frames, study.scenario.frame_count)) - 1)
