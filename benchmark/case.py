"""A case of a suite: a scenario with its frames, on which methods meet; one data set, or one for each of several seeds."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field, StringConstraints, model_validator

from benchmark.limits import Limits
from benchmark.subjects import Subject, of_feature
from scenes.dataset_range import parse_frames
from scenes.errors import UsageError, unknown
from scenes.features import CircleFeature, Feature, MarkerFeature
from scenes.scenario import Quality, Scenario
from scenes.spec import NonNegative, Spec

Name = Annotated[str, StringConstraints(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=64)]  # becomes a folder's name
Seed = Annotated[int, Field(ge=0)]
SeedCount = Annotated[int, Field(ge=1, le=1000)]
BoundSamples = Annotated[int, Field(ge=4, le=4096)]  # of a pixel in each rendering for its information


@dataclass(frozen=True, slots=True)
class CaseRun:
    """One data set of a case: its name, the case's, and the seed, None for the scenario's own."""

    name: str
    base: str
    seed: int | None


class Case(Spec):
    """One data set: a scenario and its frames; which features and which LIDAR are asked for, by which methods (none named: all).

    The frames of the first ``settle_s`` seconds are answered but not judged: a filter needs time that a frame-by-frame
    method does not. ``quality``, ``prior_sigma_px``, ``limits``, ``bounds`` and ``bound_samples`` go before the suite's own. A
    circle is measured by the stereo rig ``rig``, which needs no name where the scenario has one. Instead of features a case may
    ask for what ``lidar`` measures, which needs no name where the scenario has nothing else. ``seeds``, a list or how many from 0,
    makes a data set of each.
    """

    name: Name
    scenario: Scenario
    description: str = ""
    frames: str = ":"
    seed: Seed | None = None
    seeds: tuple[Seed, ...] | SeedCount = ()
    settle_s: NonNegative = 0.0
    quality: Quality | None = None
    prior_sigma_px: NonNegative | None = None
    limits: Limits | None = None
    bounds: str | None = None
    bound_samples: BoundSamples | None = None
    rig: str | None = None
    lidar: str | None = None
    features: tuple[str, ...] = ()
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

    @model_validator(mode="after")
    def _bounds_are_of_its_frames(self) -> "Case":
        if self.bounds is not None:
            self.bounded(self.bounds)
        return self

    @model_validator(mode="after")
    def _asks_for_something(self) -> "Case":
        lidars = self.scenario.lidars
        if self.lidar is not None and self.lidar not in lidars:
            raise ValueError(unknown("LIDAR of the scenario", self.lidar, lidars))
        if not self.features and not lidars:
            raise ValueError("features: a case names at least one feature of the target, or its scenario has a LIDAR")
        if not self.features and self.lidar is None and (len(lidars) > 1 or self.scenario.sensors):
            raise ValueError(f"the scenario has several sensors; name features or the lidar, one of {', '.join(sorted(lidars))}")
        if self.features and not self.scenario.sensors:
            raise ValueError("features are measured by cameras, and the scenario has none; leave them out for its LIDAR")
        return self

    @model_validator(mode="after")
    def _each_seed_once(self) -> "Case":
        if self.seeds and self.seed is not None:
            raise ValueError("a case has a seed or seeds, not both")
        if isinstance(self.seeds, tuple) and len(set(self.seeds)) < len(self.seeds):
            raise ValueError(f"seeds: the seed {next(one for one in self.seeds if self.seeds.count(one) > 1)} is there twice")
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

    def bounded(self, bounds: str) -> range:
        """The places among its frames that ``bounds`` names. Raises ``ValueError`` where it has no such."""
        try:
            return parse_frames(bounds, len(self.selected))
        except UsageError as error:
            raise ValueError(str(error).replace("--frames", "bounds")) from None

    @property
    def subjects(self) -> tuple[Subject, ...]:
        """The features in their order, then the LIDAR."""
        there = {feature.name: feature for feature in self.scenario.target.features}
        lidar = self.lidar if self.features else self.lidar or next(iter(self.scenario.lidars))
        scanned = () if lidar is None else (Subject(lidar, "lidar"),)
        return (*(of_feature(there[name]) for name in self.features), *scanned)

    @property
    def runs(self) -> tuple[CaseRun, ...]:
        """The data sets: one under the case's name, or ``<name>-seed<k>`` for each of the seeds."""
        seeds = tuple(range(self.seeds)) if isinstance(self.seeds, int) else self.seeds
        if not seeds:
            return (CaseRun(self.name, self.name, self.seed),)
        return tuple(CaseRun(f"{self.name}-seed{seed}", self.name, seed) for seed in seeds)
