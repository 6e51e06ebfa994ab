"""A suite: which methods meet which scenarios, on which frames and features, and what they are told. Data, no logic."""

from collections import Counter
from typing import Annotated, Any

from pydantic import Field, model_validator

from benchmark.case import Case, CaseRun, Name
from benchmark.limits import Limits
from benchmark.published import Published, PublishedFilter, PublishedRing
from scenes.config import load
from scenes.errors import unknown
from scenes.scenario import MATERIAL_REFERENCES, REFERENCES, Quality
from scenes.spec import NonNegative, Spec

__all__ = ["Case", "CaseRun", "Method", "Note", "Published", "PublishedFilter", "PublishedRing", "Suite", "load_suite"]

_SCENARIO = "cases.*.scenario"
_REFERENCES = {_SCENARIO: "scenario"} | {f"{_SCENARIO}.{path}": kind for path, kind in (REFERENCES | MATERIAL_REFERENCES).items()}


class Method(Spec):
    """A registered estimator (or ``package.module:Class``) with its parameters.

    ``aspect`` grants it a rectangle's L/W, ``radius`` a circle's radius, ``model`` a cloud of the target's surface for a LIDAR.
    """

    estimator: str
    parameters: dict[str, Any] = Field(default_factory=dict)
    aspect: bool = False
    radius: bool = False
    model: bool = False


class Note(Spec):
    """A paragraph of explanation on the report's page."""

    title: str
    text: str


class Suite(Spec):
    """A leaderboard's rules. ``limits``: what a method may cost on one data set before it is stopped."""

    title: str
    description: str
    prior_sigma_px: NonNegative = 3.0
    quality: Quality | None = None
    limits: Limits = Limits()
    methods: Annotated[dict[Name, Method], Field(min_length=1)]
    cases: tuple[Case, ...]
    published: tuple[Published, ...] = ()
    published_rings: tuple[PublishedRing, ...] = ()
    published_filters: tuple[PublishedFilter, ...] = ()
    notes: tuple[Note, ...] = ()

    @model_validator(mode="after")
    def _names_refer_to_something(self) -> "Suite":
        if not self.cases:
            raise ValueError("a suite has at least one [[cases]]")
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
    def _models_are_for_lidars(self) -> "Suite":
        for case in self.cases:
            granted = [name for name, method in self.methods_of(case).items() if method.model]
            if case.features and granted:
                raise ValueError(
                    f"case {case.name!r}: method {granted[0]!r} is granted a model of the target, which is for a LIDAR, and the "
                    "case asks for features; name its methods"
                )
        return self

    def methods_of(self, case: Case) -> dict[str, Method]:
        """The methods that a case is for, in the suite's order."""
        return {name: method for name, method in self.methods.items() if not case.methods or name in case.methods}


def load_suite(name_or_path: str) -> Suite:
    """The suite of a library name or a TOML file, its scenarios resolved. Raises ``ConfigError`` with every fault."""
    return load("suite", name_or_path, Suite, references=_REFERENCES)
