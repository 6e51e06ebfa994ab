"""study.json: what a study's folder says of itself, from which scores and pages are made without its TOML."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from benchmark.files import publish, read_record
from benchmark.subjects import Modality
from benchmark.suite import Note
from scenes.spec import Spec

if TYPE_CHECKING:
    from benchmark.study.spec import Study

FILE, POINTS = "study.json", "points.parquet"


class FactorRecord(Spec):
    """A factor as scores and pages need it: ``baseline`` is the number that the scenario has, ``light`` the light it is about."""

    name: str
    title: str
    unit: str = ""
    kind: Literal["number", "direction"] = "number"
    scale: Literal["linear", "log"] = "linear"
    baseline: float | None = None
    dimensions: Annotated[int, Field(ge=1, le=2)] = 1
    light: str = ""


class StudyRecord(Spec):
    """What was studied and how. ``samples``: N of a Sobol design, else 0. ``refused``: point → why it could not be rendered."""

    format: Literal["hardlight-study"] = "hardlight-study"
    version: Literal[1] = 1
    title: str
    description: str = ""
    design: Literal["one-at-a-time", "factorial", "sphere", "sobol"]
    seed: int = 0
    samples: int = 0
    command: str = ""
    factors: tuple[FactorRecord, ...]
    references: dict[Modality, str] = Field(default_factory=dict)
    frozen: dict[Modality, dict[str, float]] = Field(default_factory=dict)
    notes: tuple[Note, ...] = ()
    refused: dict[str, str] = Field(default_factory=dict)


def factor_records(study: "Study") -> tuple[FactorRecord, ...]:
    """The factors in their order."""
    tree = study.scenario.model_dump(mode="json")
    found = []
    for name, factor in study.factors.items():
        own = factor.baseline(tree)
        found.append(
            FactorRecord(
                name=name,
                title=factor.title,
                unit=factor.unit,
                kind="direction" if factor.dimensions == 2 else "number",
                scale=factor.scale,
                baseline=None if isinstance(own, tuple) else own,
                dimensions=factor.dimensions,
                light=getattr(factor, "light", ""),
            )
        )
    return tuple(found)


def record_of(study: "Study", command: str, refused: dict[str, str]) -> StudyRecord:
    """What will be said of a study that was run by ``command``."""
    return StudyRecord(
        title=study.title,
        description=study.description,
        design=study.design,
        seed=study.seed,
        samples=study.samples if study.design == "sobol" else 0,
        command=command,
        factors=factor_records(study),
        references=study.references,
        frozen=study.frozen,
        notes=study.notes,
        refused=refused,
    )


def write(folder: Path, found: StudyRecord) -> None:
    """Writes study.json."""
    publish(folder, {FILE: (found.model_dump_json(indent=2) + "\n").encode()})


def read(folder: Path) -> StudyRecord:
    """The record in ``folder``. Raises ``PredictionsError`` where there is none or it is not one."""
    return read_record(folder, FILE, StudyRecord, "give the --out folder of hardlight study")
