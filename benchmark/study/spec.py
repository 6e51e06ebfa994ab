"""A study: one scenario, methods, what is varied and by which plan. Data, no logic."""

from typing import Annotated, Any, Literal

from pydantic import Field, ModelWrapValidatorHandler, PrivateAttr, model_validator

from benchmark.case import BoundSamples, Case, Name, Seed, SeedCount
from benchmark.limits import Limits
from benchmark.study.collisions import columns_twice, lost
from benchmark.study.factor import Factor, refused
from benchmark.subjects import Modality
from benchmark.suite import Method, Note, Suite, called
from scenes.config import load
from scenes.config_tree import Table
from scenes.errors import unknown
from scenes.scenario import MATERIAL_REFERENCES, REFERENCES, Quality, Scenario
from scenes.spec import NonNegative, Spec

Design = Literal["one-at-a-time", "factorial", "sphere", "sobol"]
FactorName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,30}$")]
_BASE = "0" * 10  # a name as points have it, for the case that is only looked at
_REFERENCES = {"scenario": "scenario"} | {f"scenario.{path}": kind for path, kind in (REFERENCES | MATERIAL_REFERENCES).items()}


class Study(Spec):
    """Factors of a scenario, and the methods that meet it at every point of the design.

    ``design``: each factor through its levels with the others as the scenario has them (``one-at-a-time``); all combinations of
    levels (``factorial``; ``sphere`` where the one factor is a direction); or ``samples`` · (factors + 2) points of Saltelli's
    scheme, for variance-based indices (``sobol``). Poses and random streams are the same at every point. ``bound_frames``: of which
    frames of each data set the information limit is found, from renderings of ``bound_samples`` samples a pixel. ``references``:
    for each modality the method that others are measured by; ``frozen``: its mean charge over each factor's levels as it once was,
    so that the measure stays the same.
    The other fields are a suite's (``benchmark.suite``) and a case's (``benchmark.case``).
    """

    title: str
    description: str = ""
    design: Design
    samples: Annotated[int, Field(ge=1, le=2**16)] = 8
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0
    scenario: Scenario
    frames: str = ":"
    seeds: tuple[Seed, ...] | SeedCount = ()
    quality: Quality | None = None
    prior_sigma_px: NonNegative = 3.0
    settle_s: NonNegative = 0.0
    limits: Limits = Limits()
    rig: str | None = None
    lidar: str | None = None
    features: tuple[str, ...] = ()
    methods: Annotated[dict[Name, Method], Field(min_length=1)]
    factors: Annotated[dict[FactorName, Factor], Field(min_length=1)]
    bound_frames: str | None = None
    bound_samples: BoundSamples = 16
    references: dict[Modality, str] = Field(default_factory=dict)
    frozen: dict[Modality, dict[str, float]] = Field(default_factory=dict)
    notes: tuple[Note, ...] = ()
    _name: str = PrivateAttr("study")

    @property
    def name(self) -> str:
        """The name of its file."""
        return self._name

    @model_validator(mode="wrap")
    @classmethod
    def _called_after_its_file(cls, value: Any, handler: ModelWrapValidatorHandler["Study"]) -> "Study":
        study = handler(value)
        if isinstance(value, Table):
            study._name = called(value) or study._name
        return study

    @model_validator(mode="after")
    def _is_a_suite_at_every_point(self) -> "Study":
        case = case_of(self, f"p{_BASE}", "", self.scenario)
        if self.bound_frames is not None:
            try:
                case.bounded(self.bound_frames)
            except ValueError as error:
                raise ValueError(str(error).replace("bounds", "bound_frames", 1)) from None
        suite_of(self, (case,))
        return self

    @model_validator(mode="after")
    def _factors_are_the_scenarios(self) -> "Study":
        tree = self.scenario.model_dump(mode="json")
        faults = [fault for name, factor in self.factors.items() if (fault := refused(factor, name, tree))]
        faults += columns_twice(self.factors)
        if not faults and self.design != "one-at-a-time":
            faults = lost(self.factors, tree)
        if faults:
            raise ValueError("; ".join(faults))
        directed = [name for name, factor in self.factors.items() if factor.dimensions == 2]
        if self.design == "sphere" and list(self.factors) != directed[:1]:
            raise ValueError("design 'sphere' has one factor, of type 'direction'; with more of them it is 'factorial'")
        if self.design == "sobol" and len(self.factors) < 2:
            raise ValueError("design 'sobol' tells factors apart and needs at least two")
        return self

    @model_validator(mode="after")
    def _references_are_methods(self) -> "Study":
        for modality, method in self.references.items():
            if method not in self.methods:
                raise ValueError(f"references.{modality}: {unknown('method of this study', method, self.methods)}")
        for modality, known in self.frozen.items():
            for name in known:
                if name not in self.factors:
                    raise ValueError(f"frozen.{modality}: {unknown('factor of this study', name, self.factors)}")
        return self


def case_of(study: Study, name: str, description: str, scenario: Scenario) -> Case:
    """The study's case with another scenario. Raises ``ValueError`` where it is none."""
    return Case(
        name=name,
        description=description,
        scenario=scenario,
        frames=study.frames,
        seeds=study.seeds,
        settle_s=study.settle_s,
        rig=study.rig,
        lidar=study.lidar,
        features=study.features,
    )


def suite_of(study: Study, cases: tuple[Case, ...]) -> Suite:
    """The suite whose cases are points of the study."""
    return Suite(
        title=study.title,
        description=study.description,
        prior_sigma_px=study.prior_sigma_px,
        quality=study.quality,
        limits=study.limits,
        bounds=study.bound_frames,
        bound_samples=study.bound_samples,
        methods=study.methods,
        cases=cases,
        notes=study.notes,
    )


def load_study(name_or_path: str) -> Study:
    """The study of a library name or a TOML file, its scenario resolved. Raises ``ConfigError`` with every fault."""
    return load("study", name_or_path, Study, references=_REFERENCES)
