"""A suite: which methods meet which scenarios, on which frames and features, and what they are told. Data, no logic."""

import re
from collections import Counter
from pathlib import Path
from typing import Any

from pydantic import Field, ModelWrapValidatorHandler, PrivateAttr, model_validator

from benchmark.case import BoundSamples, Case, CaseRun, Name
from benchmark.information import SAMPLES
from benchmark.limits import Limits
from benchmark.published import Published, PublishedFilter, PublishedRing
from benchmark.subjects import MEASURES, Modality, Subject
from benchmark.suite_include import merged
from scenes.config import load
from scenes.config_tree import Table
from scenes.errors import unknown
from scenes.scenario import MATERIAL_REFERENCES, REFERENCES, Quality
from scenes.spec import NonNegative, Spec

__all__ = ["Case", "CaseRun", "Method", "Note", "Published", "PublishedFilter", "PublishedRing", "Suite", "load_suite"]

_SCENARIO = "cases.*.scenario"
_INCLUDE, _DEPTH = "include.*", 3  # suites that include suites that include suites
_IN_SUITES = {_INCLUDE: "suite", _SCENARIO: "scenario"} | {
    f"{_SCENARIO}.{path}": kind for path, kind in (REFERENCES | MATERIAL_REFERENCES).items()
}
_REFERENCES = {".".join([_INCLUDE] * level + [path]): kind for level in range(_DEPTH + 1) for path, kind in _IN_SUITES.items()}


class Method(Spec):
    """A registered estimator (or ``package.module:Class``) with its parameters.

    ``aspect`` grants it a rectangle's L/W, ``radius`` a circle's radius, ``model`` a cloud of the target's surface for a LIDAR.
    ``modality``: what it answers where a case asks for several: ``mono`` rectangles, ``stereo`` rings, ``lidar`` scans. Left out,
    it meets all that its cases ask for.
    """

    estimator: str
    modality: Modality | None = None
    parameters: dict[str, Any] = Field(default_factory=dict)
    aspect: bool = False
    radius: bool = False
    model: bool = False

    @model_validator(mode="after")
    def _is_granted_what_it_can_use(self) -> "Method":
        for grant, of in (("aspect", "mono"), ("radius", "stereo"), ("model", "lidar")):
            if getattr(self, grant) and self.modality not in (None, of):
                raise ValueError(f"{grant} is granted to methods for {MEASURES[of]}, and this one's modality is {self.modality!r}")
        return self

    def answers(self, subject: Subject) -> bool:
        """Whether it meets ``subject``."""
        return self.modality in (None, subject.modality)


class Note(Spec):
    """A paragraph of explanation on the report's page."""

    title: str
    text: str


class Suite(Spec):
    """A leaderboard's rules. ``limits``: what a method may cost on one data set before it is stopped.

    ``bounds``: of which of a case's frames, START:STOP:STEP by their place in it, the information limit is found, so that methods
    have an efficiency; of none where left out. ``bound_samples``: of a pixel in each rendering for it.

    ``include`` names other suites, whose methods, cases, published figures and notes come before its own; each of their cases keeps
    its suite's quality, prior and limits. It is empty in what is validated: what was included is there (``suite_include``).
    """

    title: str
    description: str
    include: tuple["Suite", ...] = ()
    prior_sigma_px: NonNegative = 3.0
    quality: Quality | None = None
    limits: Limits = Limits()
    bounds: str | None = None
    bound_samples: BoundSamples = SAMPLES
    methods: dict[Name, Method] = Field(default_factory=dict)
    cases: tuple[Case, ...] = ()
    published: tuple[Published, ...] = ()
    published_rings: tuple[PublishedRing, ...] = ()
    published_filters: tuple[PublishedFilter, ...] = ()
    notes: tuple[Note, ...] = ()
    _name: str = PrivateAttr("suite")

    @property
    def name(self) -> str:
        """The name of the suite's file, in letters that a case's name may have."""
        return self._name

    @model_validator(mode="wrap")
    @classmethod
    def _called_after_its_file(cls, value: Any, handler: ModelWrapValidatorHandler["Suite"]) -> "Suite":
        suite = handler(value)
        if isinstance(value, Table):
            suite._name = called(value) or suite._name
        return suite

    @model_validator(mode="after")
    def _with_what_it_includes(self) -> "Suite":
        return merged(self) if self.include else self

    @model_validator(mode="after")
    def _names_refer_to_something(self) -> "Suite":
        if not self.methods:
            raise ValueError("a suite has at least one [methods.<name>], or includes a suite")
        if not self.cases:
            raise ValueError("a suite has at least one [[cases]], or includes a suite")
        names = [case.name for case in self.cases]
        of_seeds = [run.name for case in self.cases if case.seeds for run in case.runs]
        for name, count in Counter(names + of_seeds).items():
            if count > 1:
                raise ValueError(f"two cases are called {name!r}")
        for case in self.cases:
            for method in case.methods:
                if method not in self.methods:
                    raise ValueError(f"case {case.name!r}: {unknown('method of this suite', method, self.methods)}")
        printed = [*(one.case for one in self.published), *(one.case for one in self.published_rings)]
        for case_name in (*printed, *(one.case for one in self.published_filters)):
            if case_name not in names:
                raise ValueError(f"published: {unknown('case of this suite', case_name, names)}")
        return self

    @model_validator(mode="after")
    def _bounds_are_of_every_cases_frames(self) -> "Suite":
        for case in self.cases:
            if self.bounds is not None and case.bounds is None:
                try:
                    case.bounded(self.bounds)
                except ValueError as error:
                    raise ValueError(f"case {case.name!r}: {error}") from None
        return self

    @model_validator(mode="after")
    def _subjects_meet_methods(self) -> "Suite":
        for case in self.cases:
            for name, method in self.methods_of(case).items():
                if case.features and method.modality is None:
                    _refuse_doubt(case, name, method)
            for subject in case.subjects:
                if not self.methods_for(case, subject):
                    raise ValueError(
                        f"case {case.name!r}: no method answers {subject}; one with modality = {subject.modality!r} would, or one "
                        "without a modality"
                    )
        return self

    def methods_of(self, case: Case) -> dict[str, Method]:
        """The methods that a case is for, in the suite's order."""
        return {name: method for name, method in self.methods.items() if not case.methods or name in case.methods}

    def methods_for(self, case: Case, subject: Subject) -> dict[str, Method]:
        """Those of them that answer one of its subjects."""
        return {name: method for name, method in self.methods_of(case).items() if method.answers(subject)}


def called(table: Table) -> str:
    """The name of the file that a table came from, in letters that a folder may have; empty where none is left."""
    return re.sub("[^a-z0-9]+", "-", Path(table.origin.label).stem.lower()).strip("-")


def _refuse_doubt(case: Case, name: str, method: Method) -> None:
    """Of a method without a modality: refuses it where the case asks for features and it, or the case, is for a LIDAR."""
    if case.lidar is not None:
        raise ValueError(
            f"case {case.name!r} asks for features and for what the LIDAR {case.lidar!r} measures, and method {name!r} does not "
            "say which of them it answers; give it modality = 'mono' (rectangles), 'stereo' (rings) or 'lidar' (scans), or name "
            "the case's methods"
        )
    if method.model:
        raise ValueError(
            f"case {case.name!r}: method {name!r} is granted a model of the target, which is for a LIDAR, and the case asks for "
            "features; name its methods, or give it modality = 'lidar'"
        )


def load_suite(name_or_path: str) -> Suite:
    """The suite of a library name or a TOML file, its scenarios resolved. Raises ``ConfigError`` with every fault."""
    return load("suite", name_or_path, Suite, references=_REFERENCES)
