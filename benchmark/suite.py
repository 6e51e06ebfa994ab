"""A suite: which methods meet which scenarios, on which frames and features, and what they are told. Data, no logic."""

from typing import Annotated, Any

from pydantic import Field, StringConstraints, model_validator

from scenes.config import load
from scenes.dataset_range import parse_frames
from scenes.errors import UsageError, unknown
from scenes.features import CircleFeature, Feature, MarkerFeature
from scenes.scenario import MATERIAL_REFERENCES, REFERENCES, Quality, Scenario
from scenes.spec import NonNegative, Positive, Spec, Vector3

_SCENARIO = "cases.*.scenario"
_REFERENCES = {_SCENARIO: "scenario"} | {f"{_SCENARIO}.{path}": kind for path, kind in (REFERENCES | MATERIAL_REFERENCES).items()}

Name = Annotated[str, StringConstraints(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=64)]  # becomes a folder's name


class Method(Spec):
    """A registered estimator (or ``package.module:Class``) with its parameters.

    ``aspect`` grants it a rectangle's L/W, ``radius`` a circle's radius.
    """

    estimator: str
    parameters: dict[str, Any] = Field(default_factory=dict)
    aspect: bool = False
    radius: bool = False


class Case(Spec):
    """One data set: a scenario and its frames; which features are asked for and by which methods (none named: all).

    The frames of the first ``settle_s`` seconds are answered but not judged: a filter needs time that a frame-by-frame
    method does not. ``quality`` goes before the suite's own. A circle is measured by the stereo rig ``rig``, which needs no name
    where the scenario has one.
    """

    name: Name
    scenario: Scenario
    description: str = ""
    frames: str = ":"
    seed: Annotated[int, Field(ge=0)] | None = None
    settle_s: NonNegative = 0.0
    quality: Quality | None = None
    rig: str | None = None
    features: Annotated[tuple[str, ...], Field(min_length=1)]
    methods: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _frames_and_features_are_the_scenarios(self) -> "Case":
        try:
            parse_frames(self.frames, self.scenario.frame_count)
        except UsageError as error:
            raise ValueError(str(error).replace("--frames", "frames")) from None
        there = {feature.name: feature for feature in self.scenario.target.features}
        for name in self.features:
            if name not in there:
                raise ValueError(unknown("feature of the scenario's target", name, there))
            self._refuse_unmeasurable(there[name])
        return self

    def _refuse_unmeasurable(self, feature: Feature) -> None:
        if isinstance(feature, MarkerFeature):
            raise ValueError(f"feature {feature.name!r} is a marker; methods are told of rectangles and circles")
        if not isinstance(feature, CircleFeature):
            return
        if not self.scenario.rigs:
            raise ValueError(f"feature {feature.name!r} is a circle, which two cameras measure, and the scenario has no rig")
        if self.rig is not None and self.rig not in self.scenario.rigs:
            raise ValueError(unknown("rig of the scenario", self.rig, self.scenario.rigs))

    @property
    def selected(self) -> range:
        """The frame numbers."""
        return parse_frames(self.frames, self.scenario.frame_count)


class Published(Spec):
    """What a paper printed for a case, to stand beside our figures."""

    case: str
    source: str
    angle: str
    mean_deg: float
    max_deg: float


class PublishedRing(Spec):
    """What a paper printed for a stereo case: standard deviations of the motion from frame to frame, and seconds a frame.

    ``reason`` says why a figure is not met here, where one is not.
    """

    case: str
    source: str
    f2f_position_cm: Vector3
    f2f_rotation_deg: Vector3
    cpu_s: Positive | None = None
    reason: str = ""


class Note(Spec):
    """A paragraph of explanation on the report's page."""

    title: str
    text: str


class Suite(Spec):
    """A leaderboard's rules."""

    title: str
    description: str
    prior_sigma_px: NonNegative = 3.0
    quality: Quality | None = None
    methods: Annotated[dict[Name, Method], Field(min_length=1)]
    cases: tuple[Case, ...]
    published: tuple[Published, ...] = ()
    published_rings: tuple[PublishedRing, ...] = ()
    notes: tuple[Note, ...] = ()

    @model_validator(mode="after")
    def _names_refer_to_something(self) -> "Suite":
        if not self.cases:
            raise ValueError("a suite has at least one [[cases]]")
        names = [case.name for case in self.cases]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"two cases are called {name!r}")
        for case in self.cases:
            for method in case.methods:
                if method not in self.methods:
                    raise ValueError(f"case {case.name!r}: {unknown('method of this suite', method, self.methods)}")
        for case_name in [entry.case for entry in self.published] + [entry.case for entry in self.published_rings]:
            if case_name not in names:
                raise ValueError(f"published: {unknown('case of this suite', case_name, names)}")
        return self

    def methods_of(self, case: Case) -> dict[str, Method]:
        """The methods that a case is for, in the suite's order."""
        return {name: method for name, method in self.methods.items() if not case.methods or name in case.methods}


def load_suite(name_or_path: str) -> Suite:
    """The suite of a library name or a TOML file, its scenarios resolved. Raises ``ConfigError`` with every fault."""
    return load("suite", name_or_path, Suite, references=_REFERENCES)
