"""A study's page: whole without data sets, with their pictures where they are, in a browser, and with names that mean harm."""

import importlib.util
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from benchmark.pool import pool
from benchmark.ranking_rule import charges
from benchmark.results import CaseHeading, Entry, Results
from benchmark.study import page, record
from benchmark.study.attribution import LAYERS
from benchmark.study.outcomes import Outcomes
from benchmark.study.page_points import cards, glimpses
from benchmark.study.record import FactorRecord, StudyRecord
from benchmark.study.telling import telling
from scenes.dataset import Dataset

HOSTILE = "<img src=x onerror='window.broken = 1'>"
LARGEST = 8_000_000  # bytes
SIZES = {"desk": {"width": 1280, "height": 900}, "phone": {"width": 390, "height": 844}}


def _cost(method: str, point: pd.Series, _: int, frame: int) -> float:
    hard = point.get("sun_z", 0.0) > 0.5 or (method == HOSTILE and point.get("sun_x", 0.0) > 0.5) or point.get("gain", 0.0) > 4
    return 2.3 if hard else 0.01 + 0.001 * frame


def _bound(point: pd.Series, frame: int) -> float:
    return np.nan if point.get("sun_z", 0.0) > 0.9 else 1e-3 * (1 + frame)


def _pooled(found: Outcomes) -> Outcomes:
    """Outcomes as they are read from a folder: with what the pooled table says beside them."""
    frames, points = found.frames, found.points.assign(label=[f"place {name} {HOSTILE}" for name in found.points["point"]])
    layers = dict.fromkeys(LAYERS, frames["charge"].to_numpy() / 5)
    more = {"run": frames["point"], "dataset": "datasets/" + frames["point"], "answers": "answers", "answered": frames["right"]}
    return Outcomes(found.record, points, frames.assign(outcome="ok", wrong=False, **more, **layers))


@pytest.fixture
def whole(sphere: Any) -> Outcomes:
    return _pooled(sphere.outcomes(_cost, ("ours", HOSTILE), bound=_bound))


@pytest.fixture
def page_file(whole: Outcomes, tmp_path: Path) -> Path:
    path = tmp_path / "report.html"
    path.write_text(page.page(tmp_path, whole), encoding="utf-8")
    return path


def test_a_page_is_whole_and_fetches_nothing(page_file: Path) -> None:
    html = page_file.read_text(encoding="utf-8")
    assert len(html.encode()) < LARGEST
    assert re.findall(r'(?:src|href)="(?!#|data:)[^"]*"', html) == []
    assert re.findall(r"https?://(?!www\.w3\.org)", html) == []
    assert HOSTILE not in html
    targets = set(re.findall(r'href="#([^"]+)"', html))
    ids = re.findall(r'\bid="([^"]+)"', html)
    assert targets <= set(ids)
    assert len(ids) == len(set(ids))
    assert sum(one.startswith("point-") for one in ids) == 49
    assert "Sun" in html
    assert "the Sun&#39;s direction: 49 directions" in html


def test_each_design_has_the_sections_that_it_can_have(
    whole: Outcomes, ladder: Callable[..., Any], crossed: Callable[..., Any], tmp_path: Path
) -> None:
    def sections(found: Outcomes) -> list[str]:
        return re.findall(r'<section id="([^"]+)"', page.page(tmp_path, found))

    always = ["design", "scores", "points"]
    assert sections(whole) == ["design", "maps", "attribution", *always[1:]]
    assert sections(_pooled(ladder().outcomes(_cost, frames=3))) == ["design", "curves", *always[1:]]
    assert sections(_pooled(crossed().outcomes(_cost, frames=3))) == ["design", "curves", "attribution", *always[1:]]


def test_a_sobol_study_shows_where_the_variance_comes_from(tmp_path: Path) -> None:
    from benchmark.study.problem import samples

    factors = tuple(FactorRecord(name=name, title=name) for name in ("gain", "idle"))
    unit = samples(factors, 8, 0)
    points = pd.DataFrame(unit, columns=["gain", "idle"]).assign(point=[f"p{row}" for row in range(len(unit))], moved="", label="")
    said = StudyRecord(title="S", design="sobol", samples=8, factors=factors, refused={"p9": f"inside {HOSTILE}"})
    frames = pd.DataFrame(
        [(point, frame, gain) for point, gain in zip(points["point"], points["gain"], strict=True) for frame in range(2)],
        columns=["point", "frame", "charge"],
    ).assign(case="", subject="panel", sensor="nav", modality="mono", method="ours", seed=np.nan, right=True, geodesic_deg=1.0)
    none = {"bound_rotation_rad": np.nan, "bound_asked": False, "bound_determined": False}
    html = page.page(tmp_path, _pooled(Outcomes(said, points, frames.assign(**none))))
    assert 'id="sensitivity"' in html
    assert 'id="maps"' not in html
    assert 'id="curves"' not in html
    assert "left out" in html
    assert HOSTILE not in html


def test_a_point_shows_what_its_camera_saw(make_dataset: Callable[..., Dataset], tmp_path: Path) -> None:
    make_dataset(tmp_path / "datasets" / "p1", frames=range(2))
    rows = pd.DataFrame({"dataset": ["datasets/p1"], "frame": [1], "modality": ["mono"], "sensor": ["nav"]})
    (seen,) = glimpses(tmp_path, rows, 60)
    assert (seen.camera, seen.width) == ("nav", 60)
    assert seen.uri.startswith("data:image/webp;base64,")
    assert list(glimpses(tmp_path, rows.assign(dataset="datasets/p2"), 60)) == []


def test_telling_frames_come_with_their_pictures_and_figures(
    make_dataset: Callable[..., Dataset], judged_entry: Callable[..., Entry], toy: Any, tmp_path: Path
) -> None:
    dataset = make_dataset(tmp_path / "datasets" / "p1", frames=range(6))
    entry = judged_entry(dataset, tmp_path, "entries", HOSTILE, toy()).model_copy(update={"dataset": "datasets/p1", "case": "p1"})
    frames = pool(tmp_path, Results(title="t", cases=(CaseHeading(name="p1"),), entries=(entry,)))
    sigma = 1e-3 * (1.0 + np.arange(len(frames)))
    right = (frames["frame"] != 0).to_numpy()
    bounded = {"bound_rotation_rad": sigma, "bound_asked": True, "bound_determined": True}
    frames = frames.assign(point="p1", charge=charges(frames), right=right, **bounded)
    points = pd.DataFrame({"point": ["p1"], "moved": [""], "label": ["phase 0°"], "a": [0.0]})
    found = Outcomes(StudyRecord(title="t", design="factorial", factors=(FactorRecord(name="a", title="a"),)), points, frames)
    failed, poor = telling(tmp_path, found)
    assert failed.heading == "One camera: the light was good, the method failed"
    assert (failed.frame, failed.link, failed.label, failed.method) == (0, "point-p1", "phase 0°", HOSTILE)
    assert failed.bound.startswith("0.057°, the best of all; the answer is ")
    assert poor.heading == "One camera: the light took the most"
    assert poor.bound.startswith("0.344°, 6 times the best, better in 5 of 6 frames")
    (view,) = failed.views
    assert {"true", "answered"} <= {shape.kind for shape in view.shapes}
    undetermined = frames.assign(bound_rotation_rad=np.where(frames["frame"] == 4, np.nan, sigma))
    lost = list(telling(tmp_path, Outcomes(found.record, points, undetermined)))[-1]
    assert (lost.heading, lost.frame) == ("One camera: the light left the pose undetermined", 4)
    assert lost.bound.startswith("undetermined")
    assert list(telling(tmp_path / "elsewhere", found)) == []
    mostly = Outcomes(found.record, points, frames.assign(bound_rotation_rad=np.where(frames["frame"] < 3, np.nan, sigma)))
    (known,), (unknown,) = (cards(tmp_path, one) for one in (found, mostly))
    assert (known.lines[0].bound, unknown.lines[0].bound) == ("0.201°", "undetermined")


def test_the_page_is_written_beside_results(
    ladder: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = _pooled(ladder().outcomes(_cost, frames=3))
    monkeypatch.setattr(page, "outcomes", lambda _: found)
    written = page.write(tmp_path)
    assert written == tmp_path / "report.html"
    assert written.read_text(encoding="utf-8").startswith("<!doctype html>")
    assert not (tmp_path / record.FILE).exists()


def test_a_cell_and_the_list_lead_to_a_points_card(browser: Any, page_file: Path) -> None:
    context = browser.new_context(viewport=SIZES["desk"], reduced_motion="reduce")
    shown, said = context.new_page(), list[str]()
    shown.on("console", lambda message: said.append(message.text))
    shown.on("pageerror", lambda error: said.append(str(error)))
    shown.goto(page_file.as_uri())
    assert shown.locator(".card:visible").count() == 1
    shown.locator(".sphere a[href='#point-p07'] path").first.click()
    shown.wait_for_selector("#point-p07", state="visible")
    assert shown.locator(".card:visible").count() == 1
    assert shown.locator("#points-list").input_value() == "point-p07"
    shown.select_option("#points-list", "point-p11")
    assert shown.locator("#point-p11").is_visible()
    assert not shown.locator("#point-p07").is_visible()
    shown.select_option("#points-list", "all")
    assert shown.locator(".card:visible").count() == 49
    assert shown.evaluate("window.broken ?? 0") == 0
    assert said == []
    context.close()


@pytest.mark.parametrize(("size", "theme"), [("desk", "dark"), ("phone", "light")])
def test_an_audit_of_a_studys_page_finds_nothing(browser: Any, page_file: Path, size: str, theme: str) -> None:
    found = importlib.util.find_spec("axe_playwright_python")
    if found is None or found.origin is None:
        pytest.skip("axe-playwright-python is not installed")
    context = browser.new_context(viewport=SIZES[size], color_scheme=theme, reduced_motion="reduce")
    shown = context.new_page()
    shown.goto(page_file.as_uri())
    shown.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    assert shown.evaluate("document.documentElement.scrollWidth") <= SIZES[size]["width"]
    shown.evaluate((Path(found.origin).parent / "axe.min.js").read_text(encoding="utf-8"))
    violations = shown.evaluate("axe.run().then((found) => found.violations)")
    assert [(one["id"], [node["html"][:200] for node in one["nodes"]][:3]) for one in violations] == []
    context.close()
