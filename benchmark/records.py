"""What stands in the JSON files beside the tables: run.json of a method's answers."""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from scenes.spec import NonNegative, Spec, is_empty

Pixel = tuple[float, float]


def _plain(value: Any) -> Any:
    """As JSON has it, so that what was asked for compares with what was read back: tuples are lists."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    return [_plain(one) for one in value] if isinstance(value, list | tuple) else value


class CornerPriorRecord(Spec):
    """The four corner pixels that a method was given: P1..P4 in frame ``frame`` of ``sensor``, with their σ."""

    sensor: str
    frame: int
    corners_px: tuple[Pixel, Pixel, Pixel, Pixel]
    sigma_px: NonNegative


class PairRecord(Spec):
    """The two cameras of the stereo rig that a method was told of."""

    left: str
    right: str


class ModelRecord(Spec):
    """The cloud of a target's surface that a method was told: its size, and a digest of its points and normals."""

    points: int
    digest: str


class KnowledgeRecord(Spec):
    """Everything a method was told in advance; the leaderboard prints it.

    ``feature``: the name of what it was told of, a rectangle or, where ``pair`` is there, a ring that these two cameras measure.
    ``sensors`` are cameras, ``lidars`` LIDARs.
    """

    sensors: tuple[str, ...]
    feature: str | None = None
    gap: tuple[float, float] | None = None
    free_standing: bool = False
    aspect: float | None = None
    corner_prior: CornerPriorRecord | None = None
    pair: PairRecord | None = None
    radius_m: float | None = None
    lidars: Annotated[tuple[str, ...], Field(exclude_if=is_empty)] = ()
    model: Annotated[ModelRecord | None, Field(exclude_if=is_empty)] = None

    def sentence(self) -> str:
        """The declaration as a person reads it."""
        return ", ".join(self.facts())

    def facts(self, *, named: bool = True) -> list[str]:
        """Each thing that was told; without ``named`` the feature's name is left out."""
        told = ["calibration"]
        if self.pair is not None:
            told.append("how its two cameras stand to each other")
        if self.feature is not None:
            kind = "rectangle" if self.pair is None else "ring"
            told.append(f"how the {kind}" + (f" '{self.feature}'" if named else "") + " lies on the target")
        if self.gap is not None:
            told.append("between which parts of its length the long edges are missing (where they are)")
        if self.free_standing:
            told.append("that open space surrounds it (where it does)")
        if self.aspect is not None:
            told.append(f"its aspect ratio {self.aspect:.3g}")
        if self.radius_m is not None:
            told.append(f"its radius {self.radius_m:.4g} m")
        if self.model is not None:
            told.append(f"the target's surface as {self.model.points} points")
        if self.corner_prior is not None:
            told.append(f"its 4 corner pixels in the first frame (σ {self.corner_prior.sigma_px:g} px)")
        return told


class MachineRecord(Spec):
    """Where the answers were computed; timings mean nothing without it."""

    processor: str = ""
    cores: int | None = None
    system: str = ""
    python: str = ""


class RunRecord(Spec):
    """run.json. An outside method needs ``format``, ``version``, ``method`` and ``dataset_identity``; the rest is optional.

    ``method_source``: digest of the sources that made the answers. ``notes`` is free for whatever an outside method wants to keep.
    """

    format: Literal["hardlight-predictions"]
    version: Literal[1]
    method: Annotated[str, Field(min_length=1)]
    dataset_identity: Annotated[str, Field(min_length=1)]
    label: str = ""
    method_version: str = ""
    method_source: str = ""
    parameters: Annotated[dict[str, Any], AfterValidator(_plain)] = Field(default_factory=dict)
    knowledge: KnowledgeRecord | None = None
    start_cpu_s: NonNegative | None = None
    start_wall_s: NonNegative | None = None
    machine: MachineRecord = MachineRecord()
    notes: dict[str, Any] = Field(default_factory=dict)

    @property
    def title(self) -> str:
        """The name under which the answers are ranked: the suite's label, or the method's name."""
        return self.label or self.method
