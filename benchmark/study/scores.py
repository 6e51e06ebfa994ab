"""All scores of a study in one record: levels, aggregates, break-points, sensitivities; written as scores.json and read back."""

from pathlib import Path

from benchmark.files import publish, read_record
from benchmark.study.aggregate import aggregated
from benchmark.study.break_points import break_points
from benchmark.study.level_sets import LevelSet, level_sets
from benchmark.study.levels import level_scores, overall
from benchmark.study.outcomes import Outcomes
from benchmark.study.paired import level_draws, paired
from benchmark.study.panel import Panel, panels
from benchmark.study.score_record import StudyScores
from benchmark.study.sensitivity import sensitivities

FILE = "scores.json"


def study_scores(found: Outcomes) -> StudyScores:
    """The scores of a study's outcomes; the same outcomes give the same bits."""
    levels = level_sets(found.record, found.points)
    parts = [_of_panel(found, panel, levels) for panel in panels(found.frames)]
    fields = ("overall", "levels", "errors", "means", "break_points", "sensitivity")
    return StudyScores(**{field: tuple(one for part in parts for one in getattr(part, field)) for field in fields})


def write(folder: Path, found: StudyScores) -> None:
    """Writes scores.json."""
    publish(folder, {FILE: (found.model_dump_json(indent=1) + "\n").encode()})


def read(folder: Path) -> StudyScores:
    """The scores in ``folder``. Raises ``PredictionsError`` where there are none or the file is damaged."""
    return read_record(folder, FILE, StudyScores, "run hardlight study again")


def _of_panel(found: Outcomes, panel: Panel, levels: list[LevelSet]) -> StudyScores:
    """The scores of one modality."""
    study, record = paired(panel), found.record
    factors = [level_draws(study, own) for one in levels if (own := one.of(panel)) is not None]
    errors, means = aggregated(study, factors, record)
    is_sobol = record.design == "sobol"
    return StudyScores(
        overall=overall(study),
        levels=tuple(score for draws in factors for score in level_scores(study, draws)),
        errors=errors,
        means=means,
        break_points=tuple(one for draws in factors for one in break_points(study, draws)),
        sensitivity=sensitivities(panel, record.factors, list(found.points["point"]), record.seed) if is_sobol else (),
    )
