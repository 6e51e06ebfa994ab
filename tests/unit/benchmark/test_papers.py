"""The papers' tables: verdicts are computed, every miss has its reason, every misprint a test that exists."""

import ast
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from jinja2 import Environment, PackageLoader, StrictUndefined
from pydantic import ValidationError

from benchmark.figure import Figure
from benchmark.leaderboard import minus
from benchmark.methods import parameters_of
from benchmark.paper_spec import Group, Misprint, Paper, PaperFigure, Place, load_papers
from benchmark.paper_values import Measured
from benchmark.papers import PaperView, papers, view
from benchmark.results import CaseHeading, Entry, Results, read
from benchmark.suite import load_suite
from benchmark.summary import Summary
from estimators import registry

ROOT = Path(__file__).parents[3]
YEARS = (2014, 2017, 2020)
REFERENCES = ("seeds", "zhai2014", "song2017", "shu2020")  # where committed results of the papers' experiments may lie
PLACE = Place(case="turn", feature="wing", label="wing", frames=10)


@pytest.fixture(scope="module")
def views() -> dict[int, PaperView]:
    """The section of each paper from the committed results."""
    folders = [ROOT / "results" / name for name in REFERENCES if (ROOT / "results" / name / "results.json").is_file()]
    found: dict[int, PaperView] = {}
    for one in (section for folder in folders for section in papers(folder, read(folder))):
        found.setdefault(one.year, one)
    assert sorted(found) == list(YEARS)
    return found


def _swept(mean_deg: float, slope: float) -> dict[str, Any]:
    figure = {"value": mean_deg, "low": mean_deg - 0.1, "high": mean_deg + 0.1}
    rest = {"response_slope": slope, "near_zero_answers": 0, "lag1_autocorrelation": None, "bins": []}
    return {"name": "theta2", "mean_deg": figure, "sd_deg": figure, "mae_deg": figure, "max_deg": 2 * abs(mean_deg)} | rest


def _measured(frames: int = 10, mean_deg: float | None = -0.2, slope: float = 1.0) -> Measured:
    answered = 0 if mean_deg is None else frames
    summary = Summary.model_validate(
        {"method": "m", "title": "m", "sensor": "nav", "dataset_identity": "x", "knowledge": None, "symmetry": "none"}
        | {"frames": frames, "answered": answered, "outcomes": {}, "availability": answered / frames, "wrong": 0}
        | {"wrong_but_confident": 0.0, "label_switches": 0, "cpu_s_per_frame": 0.1}
        | {"swept": None if mean_deg is None else _swept(mean_deg, slope)}
    )
    return Measured(summary, frames, answered, frames)


def _paper(place: Place = PLACE, **changes: Any) -> Paper:
    figure = {"name": "mean", "where": "section 3", "as_printed": "0.23", "printed": 0.23, "quantity": "swept.mean_deg"} | changes
    group = Group(title="g", places=(place,), figures=(PaperFigure.model_validate(figure),))
    return Paper(title="t", year=2014, description="d", theirs=("theirs",), ours=("ours",), groups=(group,))


def _verdicts(paper: Paper, **found: Measured) -> list[str]:
    (group,) = view(paper, {("turn", "wing", method): one for method, one in found.items()}).groups
    return [cell.verdict for cell in group.rows[0].cells]


@pytest.mark.parametrize(
    ("mean_deg", "slope", "changes", "verdict"),
    [
        (-0.2, 1.0, {}, "met"),
        (-0.23, 1.0, {}, "met"),
        (-0.24, 1.0, {}, "not met"),
        (0.24, 1.0, {}, "not met"),
        (None, 1.0, {}, "not met"),  # no answer meets nothing
        (0.0, 0.1, {"follows": 0.5}, "not comparable"),  # a constant's mean is zero
        (0.0, 0.6, {"follows": 0.5}, "met"),
        (0.2, 1.0, {"compare": "nothing", "reason": "r"}, "not comparable"),
        (0.2, 1.0, {"printed": None, "reason": "r"}, "not comparable"),
        (10.0, 1.0, {"printed": 10, "quantity": "answered", "compare": "at least"}, "met"),
        (10.0, 1.0, {"printed": 11, "quantity": "answered", "compare": "at least"}, "not met"),
        (0.4, 1.0, {"per": "swept.max_deg", "printed": 0.5}, "met"),
        (0.2, 1.0, {"scale": 2.0}, "not met"),
    ],
)
def test_verdicts_are_computed(mean_deg: float | None, slope: float, changes: dict[str, Any], verdict: str) -> None:
    assert _verdicts(_paper(**changes), ours=_measured(mean_deg=mean_deg, slope=slope)) == [verdict]


def test_a_row_holds_both_sides_and_the_reason_of_what_is_not_met() -> None:
    place = PLACE.model_copy(update={"reason": "of the place"})
    found = {("turn", "wing", "theirs"): _measured(mean_deg=2.0), ("turn", "wing", "ours"): _measured()}
    for reasons, expected in (({}, "of the place"), ({"wing": "its own"}, "its own")):
        (group,) = view(_paper(place, reasons=reasons, reason="of the figure"), found).groups
        (row,) = group.rows
        assert [(cell.method, cell.verdict) for cell in row.theirs] == [("theirs", "not met")]
        assert [(cell.method, cell.verdict, cell.interval) for cell in row.ours] == [("ours", "met", pytest.approx((-0.3, -0.1)))]
        assert row.reason == expected
    found.pop(("turn", "wing", "theirs"))
    shown = view(_paper(place), found)
    assert shown.groups[0].rows[0].reason == ""  # what is met needs none
    assert [(one.method, one.is_ours, one.met, one.compared) for one in shown.counts] == [("ours", True, 1, 1)]


def test_another_number_of_frames_is_another_experiment() -> None:
    assert view(_paper(), {("turn", "wing", "ours"): _measured(frames=9)}).groups == ()
    assert view(_paper(), {("other", "wing", "ours"): _measured()}).groups == ()


def test_a_path_leads_through_attributes_keys_and_places() -> None:
    source = {"states": {"p": (Figure(value=-3.0), Figure(value=2.0))}, "flag": True, "none": None}
    one = Measured(source, 1, 1, 1)
    assert one.value("states.p.1") == 2.0
    assert one.value("states.p") == 3.0  # the largest magnitude
    assert one.value("flag") == 1.0
    assert one.value("none.of.it") is None
    assert one.value("nowhere") is None
    assert one.interval("states.p.0") is None
    with pytest.raises(AttributeError):
        _measured().value("swept.median_deg")


def test_what_is_compared_with_nothing_says_why() -> None:
    with pytest.raises(ValidationError, match="compared with nothing; say why"):
        _paper(compare="nothing")
    with pytest.raises(ValidationError, match="no place is called 'face'"):
        _paper(reasons={"face": "x"})


def test_results_of_other_suites_have_no_papers(tmp_path: Path) -> None:
    entry = Entry(case="mine", feature="wing", title="m", dataset="d", answers="e", scores="e")
    assert papers(tmp_path, Results(title="t", cases=(CaseHeading(name="mine"),), entries=(entry,))) == ()


@pytest.mark.parametrize("year", YEARS)
def test_every_miss_has_its_reason(views: dict[int, PaperView], year: int) -> None:
    for group in views[year].groups:
        for row in group.rows:
            unmet = [cell for cell in row.cells if cell.verdict != "met"]
            assert bool(row.reason) == bool(unmet or not row.cells), (group.title, row.figure.name, row.place)


def test_ours_meets_what_the_readme_says(views: dict[int, PaperView]) -> None:
    counts = {one.method: (one.met, one.compared) for paper in views.values() for one in paper.counts}
    assert counts["stereo-ring-filtered"][0] == counts["stereo-ring-filtered"][1] >= 30
    assert counts["lidar-ekf"] == (10, 10)
    met, compared = counts["stereo-ring"]
    assert compared - met == 2  # x in experiments 2 and 3
    rows = [row for group in views[2014].groups for row in group.rows if row.place and not row.place.case.startswith("display")]
    missed = [(row.figure.name, cell.method) for row in rows for cell in row.ours if cell.verdict == "not met"]
    assert missed == [("yaw error, mean", "mono-rectangle")]  # of the face


@pytest.mark.parametrize("paper", load_papers(), ids=lambda paper: str(paper.year))
def test_every_place_is_a_case_of_seeds_and_every_path_leads_somewhere(paper: Paper, views: dict[int, PaperView]) -> None:
    seeds = load_suite("seeds")
    cases = {case.name: case for case in seeds.cases}
    for place in paper.places:
        case = cases[place.case]
        settled = int(case.settle_s * case.scenario.rate_hz)
        assert place.frames == len(case.selected) - settled
        assert place.feature in case.features or (place.feature is None and not case.features)
        assert {*seeds.methods_of(case)} <= {*paper.theirs, *paper.ours}
    rows = [row for group in views[paper.year].groups for row in group.rows]
    for figure in (figure for group in paper.groups for figure in group.figures if figure.quantity is not None):
        mine = [cell for row in rows if row.figure == figure for cell in row.cells]
        assert any(cell.value is not None for cell in mine), figure.name


@cache
def _tests_of(path: str) -> set[str]:
    """The names of a test file's functions, read and not run."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}


MISPRINTS = [(paper, one) for paper in load_papers() for one in paper.misprints]


def test_the_papers_are_read_with_care() -> None:
    assert [(paper.year, len(paper.misprints)) for paper in load_papers()] == [(2014, 8), (2017, 19), (2020, 20)]
    assert len({(paper.year, one.where) for paper, one in MISPRINTS}) == len(MISPRINTS)


@pytest.mark.parametrize(("paper", "one"), MISPRINTS, ids=lambda one: getattr(one, "where", None) or str(getattr(one, "year", "")))
def test_every_misprint_has_a_number_and_a_test_that_exists(paper: Paper, one: Misprint) -> None:
    assert paper.year
    assert re.search(r"\d", one.effect)
    assert one.effect.endswith(".")
    for test in one.tests:
        path, _, name = test.partition("::")
        assert (ROOT / path).is_file(), test
        assert name in _tests_of(path), test
    if one.as_printed is not None:
        given = parameters_of(one.as_printed.settings)
        assert given == one.as_printed.parameters
        assert registry.load(one.as_printed.estimator, **given)


@pytest.mark.parametrize("year", YEARS)
def test_the_section_shows_it_all_and_trusts_nothing(views: dict[int, PaperView], year: int) -> None:
    loader = PackageLoader("benchmark", "templates")
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["minus"] = minus
    html = str(
        environment.from_string('{% import "papers.html.j2" as papers %}{{ papers.section(views) }}').render(views=[views[year]])
    )
    shown = views[year]
    assert html.count("<tr") >= sum(len(group.rows) for group in shown.groups)
    for misprint in shown.misprints:
        for test in misprint.tests:
            assert test in html
    assert "<script" not in html
    ids = re.findall(r'\bid="([^"]+)"', html)
    assert len(ids) == len(set(ids))
    assert {*re.findall(r'href="#([^"]+)"', html)} <= {*ids}
    assert not re.search(r">\s*-\d", html)  # minus signs, not hyphens
