"""report.html of a study: one self-contained page, from its outcomes and scores. Nothing in it is fetched from a network."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmark.files import publish
from benchmark.ranking_cells import counted
from benchmark.ranking_rule import SENTENCE
from benchmark.report import PAGE, environment
from benchmark.study import scores as scoring
from benchmark.study.attribution import LAYERS, attributions
from benchmark.study.chart_attribution import attribution_groups
from benchmark.study.chart_sensitivity import sensitivity_groups
from benchmark.study.outcomes import Outcomes, outcomes
from benchmark.study.page_curves import curve_groups
from benchmark.study.page_maps import map_groups
from benchmark.study.page_points import cards
from benchmark.study.score_cells import tables
from benchmark.study.telling import telling
from benchmark.subjects import NAMES

_SECTIONS = (
    ("maps", "Maps"),
    ("curves", "Curves"),
    ("sensitivity", "Sensitivity"),
    ("telling", "Telling frames"),
    ("attribution", "Light"),
    ("scores", "Scores"),
    ("points", "Points"),
)
_DESIGNS = {
    "one-at-a-time": "one factor at a time, the others as the scenario has them",
    "factorial": "all combinations of levels",
    "sphere": "directions that share the sphere evenly",
    "sobol": "Saltelli's scheme on a Sobol sequence",
}


def write(folder: Path) -> Path:
    """Makes the page of the study in ``folder`` and returns its path."""
    html = page(folder, outcomes(folder))
    publish(folder, {PAGE: html.encode()})
    return folder / PAGE


def page(folder: Path, found: Outcomes) -> str:
    """The page of what came out of the study in ``folder``, whose data sets and scores.json need not be there."""
    return environment().get_template("study.html.j2").render(**_gathered(folder, found))


def _gathered(folder: Path, found: Outcomes) -> dict[str, Any]:
    """What the template shows: pure data of this study."""
    scores = scoring.read(folder) if (folder / scoring.FILE).is_file() else scoring.study_scores(found)
    places = {str(method): place for place, method in enumerate(dict.fromkeys(found.frames["method"]))}
    ranked, factors = tuple(attributions(found)), found.record.factors
    shown = {
        "maps": tuple(map_groups(factors, scores)),
        "curves": tuple(curve_groups(factors, scores, places)),
        "sensitivity": tuple(sensitivity_groups(factors, scores, places)),
        "telling": tuple(telling(folder, found)),
        "attribution": ranked,
        "scores": tuple(tables(scores)),
        "points": tuple(cards(folder, found)),
    }
    return {
        "record": found.record,
        "made_by": found.record.command or "hardlight study",
        "varied": tuple(_varied(found)),
        "design": _DESIGNS[found.record.design],
        "counts": _counts(found),
        "rule": SENTENCE,
        "layers": LAYERS,
        "names": NAMES,
        "against": tuple(attribution_groups(found, ranked, places)),
        "sections": [one for one in _SECTIONS if shown[one[0]]],
        **shown,
    }


def _varied(found: Outcomes) -> Iterator[str]:
    """Each factor with its levels: all of few numbers, the ends of many."""
    for factor in found.record.factors:
        unit = f" {factor.unit}" if factor.unit else ""
        if factor.kind == "direction":
            names = [f"{factor.name}_{axis}" for axis in "xyz"]
            yield f"{factor.title}: {counted(len(found.points[names].dropna().drop_duplicates()), 'direction')}"
            continue
        own = "" if factor.baseline is None else f"; the scenario has {factor.baseline:.4g}{unit}"
        yield f"{factor.title}: {_levels(found.points[factor.name], unit)}{own}"


def _levels(column: "pd.Series[float]", unit: str) -> str:
    levels = np.unique(column.dropna().to_numpy(dtype=np.float64))
    if not len(levels):
        return "as the scenario is"
    written = [f"{one:.4g}" for one in levels]
    return ", ".join(written) + unit if len(levels) <= 14 else f"{written[0]} to {written[-1]}{unit}, {len(levels)} levels"


def _counts(found: Outcomes) -> str:
    frames = found.frames
    points, runs, methods = (source.nunique() for source in (found.points["point"], frames["run"], frames["method"]))
    instants = len(frames[["run", "frame"]].drop_duplicates())
    nouns = ((points, "point"), (runs, "data set"), (instants, "frame"), (methods, "method"))
    return ", ".join(counted(number, noun) for number, noun in nouns)
