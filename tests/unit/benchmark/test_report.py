"""The page: it shows every entry, fetches nothing, and its pictures lie where the pixels are."""

import base64
import re
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from benchmark import judge, predictions, report, results
from benchmark.errors import PredictionsError
from benchmark.knowledge import declare
from benchmark.leaderboard import minus, overall, rows
from benchmark.records import RunRecord
from benchmark.report_pictures import picture
from benchmark.report_plots import Track, error_plot
from benchmark.results import CaseHeading, Entry, Results
from benchmark.run import answer
from benchmark.suite import Note, Published
from estimators.api import Estimate, Outcome
from scenes.dataset import Dataset
from scenes.recording import Observation

VOID = {"meta", "br", "img", "link", "input", "hr"}


class _Balance(HTMLParser):
    """Complains about an element that is closed out of order or not at all."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "xlink:href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "xlink:href")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def folder(dataset: Dataset, toy: Any, judged_entry: Callable[..., Entry], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of the toy method, and of one that answers a constant and fails in three frames."""

    class Zero(toy):  # type: ignore[misc]
        def step(self, observation: Observation) -> Estimate:
            if observation.frame in (4, 5, 6):
                return Estimate("nav", Outcome.NO_FEATURES, reason="too <dark> & cold")
            constant = dataset.truth(10).sensor_from_target["nav"].rotation
            return Estimate("nav", Outcome.OK, constant)

    out = tmp_path_factory.mktemp("results")
    methods = {"toy": toy(), "zero": Zero()}.items()
    entries = [judged_entry(dataset, out, title, title, estimator) for title, estimator in methods]
    index = Results(
        title="A <turning> panel",
        cases=(CaseHeading(name="turn", description="θ from −20° to 20°"),),
        entries=tuple(entries),
        published=(Published(case="turn", source="a paper", angle="theta2", mean_deg=0.1, max_deg=2.0),),
        notes=(Note(title="A note", text="with text"),),
    )
    results.write(out, index)
    return out


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return report.write(folder).read_text(encoding="utf-8")


def test_the_page_is_well_formed_and_self_contained(page: str) -> None:
    parser = _Balance()
    parser.feed(page)
    assert parser.open == []
    assert parser.links
    assert all(link.startswith(("data:image/webp;base64,", "#")) for link in parser.links)
    outside = re.findall(r"https?://(?!www\.w3\.org/)[^\s\"'<]+", page)
    assert outside == []
    assert "@import" not in page
    assert not re.search(r"<script[^>]*\bsrc\b", page)


def test_the_page_shows_every_entry_with_its_figures_knowledge_and_failures(folder: Path, page: str) -> None:
    index = results.read(folder)
    for row in rows(folder, index):
        assert f"{row.summary.answered}/{row.summary.frames}" in page
        assert row.summary.swept is not None
        assert f"{row.summary.swept.max_deg:.2f}" in page
    assert "its 4 corner pixels in the first frame (σ 3 px)" in page
    assert "no_features — too &lt;dark&gt; &amp; cold" in page
    assert "A &lt;turning&gt; panel" in page
    assert "a paper" in page
    assert "A note" in page


def test_a_constant_answer_is_explained_with_its_own_figures(folder: Path, page: str) -> None:
    zero = next(row.summary for row in rows(folder, results.read(folder)) if row.summary.title == "zero")
    assert zero.swept is not None
    assert zero.swept.near_zero_answers == zero.answered == 18
    text = " ".join(re.sub(r"<[^>]+>", "", page).split())
    assert "zero on turn, panel: within 0.5° of zero in 18 of 18 answered frames, largest error 20.0°" in text
    assert "toy on turn, panel: within" not in text


def test_no_negative_number_is_written_with_a_hyphen_in_the_tables(page: str) -> None:
    cells = re.findall(r"<td>([^<]*)", page)
    assert not [cell for cell in cells if re.search(r"(?<![\w.])-\d", cell)]


def _cases(page: str) -> str:
    """The section of the cases; the charts over all of them follow it."""
    return page.partition('id="cases"')[2].partition('id="explore"')[0]


def test_plots_are_themed_and_have_ids_of_their_own(page: str) -> None:
    svgs = re.findall(r'<svg viewBox="[^"]+" role="img" [^>]*class="plot">.*?</svg>', _cases(page), flags=re.DOTALL)
    assert len(svgs) == 1
    assert "var(--series-0)" in svgs[0]
    assert "var(--series-1)" in svgs[0]
    assert not re.search(r"#0[123]0[1-4]0", svgs[0])
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids))


def test_two_plots_on_one_page_do_not_share_ids() -> None:
    angles = np.linspace(-20, 20, 11)
    track = Track("a", 0, angles, np.sin(angles), np.arange(11) > 2)
    one, two = (error_plot([track], salt, "errors") for salt in ("in-plane-wing", "in-plane-span"))
    assert not set(re.findall(r'\bid="([^"]+)"', one)) & set(re.findall(r'\bid="([^"]+)"', two))
    assert error_plot([track], "in-plane-wing", "errors") == one


def test_each_failure_is_a_cross_in_the_plot() -> None:
    angles = np.linspace(-20, 20, 11)
    all_answered = error_plot([Track("a", 0, angles, np.zeros(11), np.ones(11, dtype=bool))], "s", "errors")
    failing = error_plot([Track("a", 0, angles, np.zeros(11), np.arange(11) >= 4)], "s", "errors")
    none = error_plot([Track("a", 0, angles, np.full(11, np.nan), np.zeros(11, dtype=bool))], "s", "errors")
    assert ">none<" not in all_answered
    assert failing.count("<use ") == all_answered.count("<use ")  # 7 circles and 4 crosses against 11 circles
    assert ">none<" in failing
    assert none.count("<use ") == all_answered.count("<use ")


def _drawn(points: str) -> np.ndarray:
    return np.array([[float(x) for x in pair.split(",")] for pair in points.split()])


def test_the_true_rectangle_lies_on_the_pictures_edges(dataset: Dataset) -> None:
    feature = dataset.features[0]
    answer_row = pd.Series({"frame": 2, "sensor": "nav", "outcome": "skipped"})
    shown = picture(dataset, feature, answer_row, "c")
    assert shown.answer == ""
    assert shown.is_failure
    webp = base64.b64decode(shown.uri.split(",", 1)[1])
    pixels = cv2.imdecode(np.frombuffer(webp, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert pixels.shape == (shown.height, shown.width)
    inside = np.zeros(pixels.shape, np.uint8)
    corners = np.round((_drawn(shown.truth) - 0.5) * 256).astype(np.int32)
    cv2.fillConvexPoly(inside, corners, 1, shift=8)
    bright = pixels > 150
    assert bright.sum() > 2000
    assert abs(int(inside.sum()) - int(bright.sum())) < 0.03 * bright.sum()
    assert (bright & (inside == 0)).sum() < 0.02 * bright.sum()


def test_an_answer_without_position_is_drawn_about_the_features_true_centre(dataset: Dataset) -> None:
    feature, truth = dataset.features[0], dataset.truth(2).sensor_from_target["nav"]
    turned = truth.rotation * Rotation.from_euler("x", 10, degrees=True)
    quaternion = turned.as_quat(scalar_first=True)
    row = {"frame": 2, "sensor": "nav", "outcome": "ok"} | dict(zip(("qw", "qx", "qy", "qz"), quaternion, strict=True))
    row |= dict.fromkeys(("tx_m", "ty_m", "tz_m"), np.nan)
    shown = picture(dataset, feature, pd.Series(row), "c")
    true, guess = _drawn(shown.truth), _drawn(shown.answer)
    assert np.linalg.norm(true.mean(axis=0) - guess.mean(axis=0)) < 1.0
    edge, turned_edge = true[1] - true[0], guess[1] - guess[0]
    angle = np.degrees(np.arctan2(*turned_edge[::-1]) - np.arctan2(*edge[::-1]))
    assert abs(abs(angle) - 10.0) < 1.0


def test_overall_adds_counts_and_weighs_the_cpu_time_by_frames(folder: Path) -> None:
    table = list(rows(folder, results.read(folder)))
    lines = {line.title: line for line in overall(table + table)}
    assert (lines["zero"].answered, lines["zero"].frames) == (36, 42)
    assert lines["toy"].cpu_s_per_frame == pytest.approx(table[0].summary.cpu_s_per_frame)


def test_a_folder_without_results_and_damaged_ones_are_refused(tmp_path: Path, folder: Path) -> None:
    with pytest.raises(PredictionsError, match=r"holds no results.json; give the --out folder"):
        report.write(tmp_path)
    (tmp_path / "results.json").write_text('{"title": 3}')
    with pytest.raises(PredictionsError, match=r"results.json is damaged: "):
        report.write(tmp_path)
    index = results.read(folder)
    with pytest.raises(PredictionsError, match=r"summary.json does not exist; run the judge again"):
        results.summaries(tmp_path, index.entries[0])


FACING_DEG = (69.282, 69.282, -69.282)  # the panel's normal, target x, towards the camera


def test_a_scenario_without_a_sweep_has_tables_and_no_plot(make_dataset: Callable[..., Dataset], toy: Any, tmp_path: Path) -> None:
    from scenes.motion import Spin

    motion = Spin(type="spin", position_m=(0.0, 0.0, 12.0), rotation_vector_deg=FACING_DEG)
    dataset = make_dataset(tmp_path / "data", frames=range(3), motion=motion)
    declared = declare(dataset, "panel")
    record = RunRecord(format="hardlight-predictions", version=1, method="toy", dataset_identity=dataset.identity)
    answers = answer(toy(), dataset, declared.knowledge, record)
    predictions.write(tmp_path / "a", answers)
    judge.write(tmp_path / "a", judge.judge(answers, dataset))
    entry = Entry(case="still", feature=None, title="toy", dataset="data", answers="a", scores="a")
    results.write(tmp_path, Results(title="t", cases=(CaseHeading(name="still"),), entries=(entry,)))
    page = report.write(tmp_path).read_text(encoding="utf-8")
    assert 'class="plot"' not in _cases(page)
    assert "not declared" in page


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("-0.25", "−0.25"),
        ("+0.25", "+0.25"),
        ("-0.00", "0.00"),
        ("+0.00", "0.00"),
        ("-0.04 … -0.00", "−0.04 … 0.00"),
        ("-0", "0"),
        ("-0.05", "−0.05"),
        ("-10 … 0°", "−10 … 0°"),
    ],
)
def test_minus_signs(text: str, written: str) -> None:
    assert minus(text) == written
