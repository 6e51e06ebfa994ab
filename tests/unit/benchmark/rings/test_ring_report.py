"""The page of a stereo case: its own columns, the printed figures beside ours, and drawings that lie where the pixels are."""

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
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark import judge, predictions, report, results
from benchmark.console import Console
from benchmark.knowledge import declare
from benchmark.leaderboard import rows
from benchmark.records import RunRecord
from benchmark.report_ring_pictures import LIGHT_STATES, strip
from benchmark.report_ring_plots import RingTrack, ring_plot
from benchmark.results import CaseHeading, Entry, Results
from benchmark.ring_subject import subject_of
from benchmark.run import answer
from benchmark.suite import Note, PublishedRing
from benchmark.verbs import _print_table
from scenes.dataset import Dataset

OFF = RigidTransform.from_components([0.0, 0.0, 0.12], Rotation.from_euler("xz", [7.0, 1.0], degrees=True))
REASON = "the stand-in is 12 cm too high"


class _Balance(HTMLParser):
    """Complains about an element that is closed out of order or not at all."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.ids += [value or "" for name, value in attrs if name == "id"]
        if tag not in {"meta", "br", "img", "link", "input", "hr"}:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.ids += [value or "" for name, value in attrs if name == "id"]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def folder(stereo: Dataset, lookup: Any, exact_ellipses: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of an exact method, and of one that is off, takes the inner edge, and has no answer at first."""
    out = tmp_path_factory.mktemp("results")
    exact, inner = exact_ellipses(stereo), exact_ellipses(stereo, radius_m=0.45)
    entries = []
    for title, method in (("exact", lookup(stereo, extras=exact)), ("off", lookup(stereo, OFF, extras=inner, missing=(0, 7)))):
        declared = declare(stereo, "ring")
        record = RunRecord(
            format="hardlight-predictions", version=1, method=title, dataset_identity=stereo.identity, knowledge=declared.record
        )
        answers = answer(method, stereo, declared.knowledge, record)
        predictions.write(out / title, answers)
        judge.write(out / title, judge.judge(answers, stereo))
        entries.append(Entry(case="nod", feature="ring", title=title, dataset=str(stereo.path), answers=title, scores=title))
    printed = PublishedRing(
        case="nod", source="a stereo paper", f2f_position_cm=(1e-6, 0.02, 0.03), f2f_rotation_deg=(0.1, 0.2, 0.3), cpu_s=1.5,
        reason=REASON,
    )  # fmt: skip
    index = Results(
        title="A <nodding> ring", cases=(CaseHeading(name="nod", description="spin and nutation"),), entries=tuple(entries),
        published_rings=(printed,), notes=(Note(title="A note", text="with text"),),
    )  # fmt: skip
    results.write(out, index)
    return out


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return report.write(folder).read_text(encoding="utf-8")


def test_the_page_is_well_formed_self_contained_and_says_nothing_of_rectangles(page: str) -> None:
    parser = _Balance()
    parser.feed(page)
    assert parser.open == []
    assert len(parser.ids) == len(set(parser.ids))
    assert all(link.startswith(("data:image/webp;base64,", "#")) for link in re.findall(r'href="([^"]*)"', page))
    assert not re.search(r"<script[^>]*\bsrc\b", page)
    assert "A &lt;nodding&gt; ring" in page
    for absent in ("Error against angle", "Bias by angle", "Swept angle", "<em>Slope</em>"):
        assert absent not in page


def test_the_page_shows_the_figures_of_both_methods(folder: Path, page: str) -> None:
    exact, off = (row.summary for row in rows(folder, results.read(folder)))
    assert exact.ring is not None
    assert off.ring is not None
    assert (exact.wrong, exact.ring.ring_right) == (0, 12)
    assert (off.answered, off.wrong, off.ring.ring_right) == (10, 10, 0)
    assert off.ring.bias_mm is not None
    text = " ".join(re.sub(r"<[^>]+>", " ", page).split())
    assert "10 ring, 10 attitude, 10 position" in text
    assert f"{off.ring.bias_mm[2].value:+.2f}".replace("-", "−") in text
    assert f"{off.ring.normal_max_deg:.2f}" in text
    assert "how its two cameras stand to each other" in text
    assert "no &lt;ellipse&gt; in the right view" in text
    assert "another ring" in text
    assert "A note" in text


def test_what_is_not_met_is_marked_and_explained(folder: Path, page: str) -> None:
    tables = re.findall(r'<table class="beside">.*?</table>', page, flags=re.DOTALL)
    assert len(tables) == 1
    assert "true motion taken out" in tables[0]
    cells = [re.findall(r"<td[^>]*>(.*?)</td>", line) for line in re.findall(r"<tr>.*?</tr>", tables[0])[1:]]
    assert [row[0] for row in cells[:3]] == ["position x (cm)", "position y (cm)", "position z (cm)"]
    assert [row[1] for row in cells] == ["0.000", "0.020", "0.030", "0.100", "0.200", "0.300", "1.500"]
    assert all("not met" not in row[2] for row in cells)
    off = next(row.summary.ring for row in rows(folder, results.read(folder)) if row.summary.title == "off")
    assert off is not None
    assert off.frame_to_frame is not None
    worse = [ours > printed for ours, printed in zip(off.frame_to_frame.noise.position_cm, (1e-6, 0.02, 0.03), strict=True)]
    assert ["not met" in row[3] for row in cells[:3]] == worse
    assert any(worse)
    assert REASON in page


def test_the_first_the_middle_and_the_worst_frame_are_shown_in_both_views_with_the_light(page: str) -> None:
    figures = re.findall(r'<figure class="ring">.*?</figure>', page, flags=re.DOTALL)
    labels = [re.findall(r'aria-label="([^"]+)"', one) for one in figures]
    assert all(len(one) == 3 for one in labels)
    assert all(one[0].startswith("left view of frame") and one[1].startswith("right view of frame") for one in labels)
    assert all(one[2].startswith("what the light did") for one in labels)
    captions = [re.search(r"<figcaption>(.*?)</figcaption>", one, flags=re.DOTALL) for one in figures]
    shown = [match[1] for match in captions if match]
    assert [re.match(r"frame \d+ \((.*?)\)", one)[1] for one in shown if "first" in one] == ["first", "first"]  # type: ignore[index]
    assert any("worst" in one for one in shown)
    for name, _, colour in LIGHT_STATES:
        assert f'<i style="background: {colour}"></i>{name}' in page


def test_no_negative_number_is_written_with_a_hyphen(page: str) -> None:
    cells = re.findall(r"<(?:td|small|figcaption)>([^<]*)", page)
    assert not [cell for cell in cells if re.search(r"(?<![\w.])-\d", cell)]


def _decoded(uri: str) -> np.ndarray:
    return np.asarray(cv2.imdecode(np.frombuffer(base64.b64decode(uri.split(",", 1)[1]), np.uint8), cv2.IMREAD_COLOR))


def _drawn(points: str) -> np.ndarray:
    return np.array([[float(x) for x in pair.split(",")] for pair in points.split()])


def test_the_true_edge_lies_on_the_pictures_edge_and_the_measured_one_on_it(
    make_stereo: Callable[..., Dataset], exact_ellipses: Any, tmp_path: Path
) -> None:
    dataset = make_stereo(tmp_path / "large", frames=range(1), width_px=720)  # as large as is shown without being made smaller
    subject = subject_of(declare(dataset, "ring").record, dataset)
    assert subject is not None
    unanswered = pd.Series({"frame": 0, "sensor": "stereo-left", "outcome": "skipped"})
    shown = strip(dataset, subject, unanswered, exact_ellipses(dataset)(0), "c")
    assert [view.name for view in shown.views] == ["left", "right"]
    for view in shown.views:
        assert view.axes == ()
        pixels = _decoded(view.uri)[..., 0]
        assert pixels.shape == (view.height, view.width)
        bright = (pixels > 215).astype(np.uint8)  # the ring itself, after gamma: the panel is at 110 DN
        contours, _ = cv2.findContours(bright, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        found = cv2.fitEllipse(max(contours, key=len).astype(np.float32))
        true = cv2.fitEllipse(_drawn(view.truth).astype(np.float32))
        assert np.abs(np.array(found[0]) + 0.5 - true[0]).max() < 0.15  # half a pixel is a mistake that is easily made
        assert np.abs(np.array(found[1]) - true[1]).max() < 1.0
        truth, measured = _drawn(view.truth), _drawn(view.measured)
        nearest = np.linalg.norm(truth[:, None] - measured[None], axis=2).min(axis=0)
        assert nearest.max() < np.linalg.norm(np.diff(truth, axis=0), axis=1).max()


def test_the_axes_start_at_the_answered_centre_and_z_comes_towards_the_cameras(stereo: Dataset) -> None:
    from scenes.pose_columns import pose_columns

    subject = subject_of(declare(stereo, "ring").record, stereo)
    assert subject is not None
    true = stereo.truth(3).sensor_from_target
    row = pd.Series({"frame": 3, "sensor": "stereo-left", "outcome": "ok"} | pose_columns(true["stereo-left"]))
    shown = strip(stereo, subject, row, {}, "c")
    for view, sensor in zip(shown.views, ("stereo-left", "stereo-right"), strict=True):
        assert view.measured == ""
        lens, truth = stereo.sensors[sensor].intrinsics, true[sensor] * subject.circle.target_from_feature
        ends = lens.project(truth.apply(np.vstack([np.zeros(3), 0.6 * np.eye(3)])))
        offset = lens.project(true[sensor].apply(subject.circle.points_target(72)))[0] - _drawn(view.truth)[0]
        for (_, points), tip in zip(view.axes, ends[1:], strict=True):
            stroke = _drawn(points) + offset
            assert np.abs(stroke[0] - ends[0]).max() < 0.11
            assert np.abs(stroke[1] - tip).max() < 0.11


def test_the_lights_picture_has_the_colours_of_the_mask(stereo: Dataset) -> None:
    subject = subject_of(declare(stereo, "ring").record, stereo)
    assert subject is not None
    shown = strip(stereo, subject, pd.Series({"frame": 0, "sensor": "stereo-left", "outcome": "skipped"}), {}, "c")
    found = {tuple(int(one) for one in colour[::-1]) for colour in np.unique(_decoded(shown.light).reshape(-1, 3), axis=0)}
    colours = {name: tuple(int(colour[at : at + 2], 16) for at in (1, 3, 5)) for name, _, colour in LIGHT_STATES}
    assert found == {colours["attached shadow"], colours["saturated"], (0x0B, 0x0C, 0x0E)}


def test_plots_are_themed_have_ids_of_their_own_and_a_cross_for_each_failure() -> None:
    frames, errors = np.arange(30.0), np.linspace(-200, 3, 30)

    def plot(salt: str, answered: np.ndarray) -> str:
        track = RingTrack("a", 0, frames, np.where(answered, errors, np.nan), np.where(answered, 0.1, np.nan), answered)
        return ring_plot([track, RingTrack("b", 1, frames, errors, np.abs(errors), np.ones(30, dtype=bool))], salt, "a <label>")

    whole, failing = plot("one", np.ones(30, dtype=bool)), plot("two", frames > 4)
    assert 'aria-label="a &lt;label&gt;"' in whole
    assert "var(--series-1)" in whole
    assert not set(re.findall(r'\bid="([^"]+)"', whole)) & set(re.findall(r'\bid="([^"]+)"', failing))
    assert failing.count("<use ") == whole.count("<use ") - 5  # ten circles less, five crosses more
    assert plot("nothing", np.zeros(30, dtype=bool)).count("<use ") > 0


def test_the_terminal_has_a_table_of_its_own_for_rings(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _print_table(folder, results.read(folder), Console(quiet=True))
    printed = capsys.readouterr().out
    assert "A <nodding> ring: rings" in printed
    assert "12/12" in printed
    assert "ring right" in printed
    assert "errors in degrees" not in printed


def test_a_case_with_a_ring_and_a_rectangle_shows_both(
    make_stereo: Callable[..., Dataset], lookup: Any, toy: Any, tmp_path: Path
) -> None:
    from scenes.features import RectangleFeature

    panel = RectangleFeature(name="panel", centre_m=(0.1, -0.2, 0.3), length_m=1.6, width_m=1.6)
    ring = next(one for one in make_stereo(tmp_path / "a", frames=range(1)).features if one.name == "ring")
    dataset = make_stereo(tmp_path / "both", frames=range(3), features=(panel, ring))
    entries = []
    for feature, method in (("panel", lookup(dataset)), ("ring", lookup(dataset))):
        declared = declare(dataset, feature)
        record = RunRecord(
            format="hardlight-predictions", version=1, method="m", dataset_identity=dataset.identity, knowledge=declared.record
        )
        answers = answer(method, dataset, declare(dataset, "ring").knowledge, record)
        predictions.write(tmp_path / feature, answers)
        judge.write(tmp_path / feature, judge.judge(answers, dataset))
        entries.append(Entry(case="both", feature=feature, title="m", dataset="both", answers=feature, scores=feature))
    results.write(tmp_path, Results(title="t", cases=(CaseHeading(name="both"),), entries=tuple(entries)))
    page = report.write(tmp_path).read_text(encoding="utf-8")
    assert "<h4>Rectangle</h4>" in page
    assert "<h4>Ring</h4>" in page
    parser = _Balance()
    parser.feed(page)
    assert len(parser.ids) == len(set(parser.ids))
