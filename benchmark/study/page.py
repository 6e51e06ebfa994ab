"""report.html of a study: one self-contained page, from its outcomes and scores. Nothing in it is fetched from a network."""

from pathlib import Path
from typing import Any

from benchmark.files import publish
from benchmark.ranking_rule import SENTENCE
from benchmark.report import PAGE, environment
from benchmark.report_charts import charts
from benchmark.study import scores as scoring
from benchmark.study.attribution import LAYERS, attributions
from benchmark.study.outcomes import Outcomes, outcomes
from benchmark.study.page_curves import curve_groups
from benchmark.study.page_maps import map_groups
from benchmark.study.page_points import cards
from benchmark.study.score_cells import tables
from benchmark.study.telling import telling
from benchmark.subjects import NAMES

_SECTIONS = (
    ("maps", "Maps"),
    ("explore", "Curves"),
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
    html = environment().get_template("study.html.j2").render(**_gathered(folder, outcomes(folder)))
    publish(folder, {PAGE: html.encode()})
    return folder / PAGE


def _gathered(folder: Path, found: Outcomes) -> dict[str, Any]:
    """What the template shows: pure data of this study."""
    scores = scoring.read(folder) if (folder / scoring.FILE).is_file() else scoring.study_scores(found)
    places = {str(method): place for place, method in enumerate(dict.fromkeys(found.frames["method"]))}
    curves = tuple(curve_groups(found.record.factors, scores, places))
    against = tuple(one for one in charts(found.frames, list(places)) if one.key.endswith("-conditions"))
    shown = {
        "maps": tuple(map_groups(found.record.factors, scores)),
        "explore": curves,
        "telling": tuple(telling(folder, found)),
        "attribution": tuple(attributions(found)),
        "scores": tuple((title, rows) for title, rows in tables(scores)),
        "points": tuple(cards(folder, found)),
    }
    return {
        "record": found.record,
        "made_by": found.record.command or "hardlight study",
        "design": _DESIGNS[found.record.design],
        "counts": _counts(found),
        "rule": SENTENCE,
        "layers": LAYERS,
        "names": NAMES,
        "against": against,
        "sections": [one for one in _SECTIONS if shown[one[0]]],
        **shown,
    }


def _counts(found: Outcomes) -> str:
    frames = found.frames
    points, runs, methods = (source.nunique() for source in (found.points["point"], frames["run"], frames["method"]))
    return f"{points} points, {runs} data sets, {len(frames[['run', 'frame']].drop_duplicates())} frames, {methods} methods"
