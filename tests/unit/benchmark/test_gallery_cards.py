"""The gallery of a small data set: cards of a good method, of one that fails and of an outside one, as a page."""

import re
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from jinja2 import Environment, PackageLoader, StrictUndefined
from scipy.spatial.transform import Rotation

from benchmark import gallery_command, judge, predictions, report_gallery
from benchmark.gallery_command import command
from benchmark.knowledge import declare
from benchmark.pool import pool
from benchmark.predictions import COLUMNS, QUATERNION, Predictions
from benchmark.records import RunRecord
from benchmark.report_gallery import Gallery, gallery
from benchmark.results import CaseHeading, Entry, Results
from scenes.dataset import Dataset
from scenes.scenario import load_scenario

HOSTILE = "</script><img src=x onerror=alert(1)> {{ 7*7 }} \"'"
VOID = {"meta", "br", "img", "link", "input", "hr", "path", "image"}


class _Tags(HTMLParser):
    """Complains about an element that is closed out of order; keeps what is there."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def _answers(dataset: Dataset, title: str, turns_deg: dict[int, float | None], told: bool = True) -> Predictions:
    """The true attitude turned about Y by so many degrees; None: no answer, with a reason."""
    truth = dataset.truth_table().sort_values("frame")
    true = Rotation.from_quat(truth[list(QUATERNION)].to_numpy(float), scalar_first=True)
    turns = [turns_deg.get(frame, 0.0) for frame in truth["frame"]]
    turned = true * Rotation.from_euler("y", [[0.0 if one is None else one] for one in turns], degrees=True)
    table = pd.DataFrame({"frame": truth["frame"].to_numpy(), "sensor": "nav", "outcome": "ok", "cpu_s": 0.01, "wall_s": 0.02})
    table[list(QUATERNION)] = turned.as_quat(canonical=True, scalar_first=True)
    lost = np.array([one is None for one in turns])
    table.loc[lost, "outcome"] = "no_features"
    table.loc[lost, list(QUATERNION)] = np.nan
    record = RunRecord(
        format="hardlight-predictions", version=1, method=title, dataset_identity=dataset.identity,
        knowledge=declare(dataset, "panel").record if told else None,
    )  # fmt: skip
    reasons = pd.DataFrame({"frame": table["frame"], "sensor": "nav", "reason": np.where(lost, HOSTILE, "")}) if told else None
    return Predictions(record, table.reindex(columns=list(COLUMNS)), reasons)


@pytest.fixture(scope="module")
def folder(dataset: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("results")
    for name, given in (
        ("a", _answers(dataset, f"mine {HOSTILE}", {3: 20.0, 8: None, 9: None})),
        ("b", _answers(dataset, "outside", {5: 8.0, 6: None}, told=False)),
    ):
        predictions.write(out / name, given)
        judge.write(out / name, judge.judge(given, dataset))
    (out / "b" / "extras.parquet").unlink()
    return out


@pytest.fixture(scope="module")
def index(dataset: Dataset) -> Results:
    entries = tuple(
        Entry(case="turn", feature="panel", title=title, dataset=str(dataset.path), answers=name, scores=name)
        for name, title in (("a", f"mine {HOSTILE}"), ("b", "outside"))
    )
    return Results(title="A panel", cases=(CaseHeading(name="turn"),), entries=entries)


def _gallery(folder: Path, index: Results) -> Gallery:
    return gallery(folder, index, pool(folder, index), [entry.title for entry in index.entries])


def _page(shown: Gallery) -> str:
    loader = PackageLoader("benchmark", "templates")
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string('{% import "gallery.html.j2" as g %}{{ g.section(view) }}').render(view=shown)


def test_the_worst_frames_are_shown_and_one_without_an_answer_has_no_answered_outline(folder: Path, index: Results) -> None:
    (shelf,) = _gallery(folder, index).shelves
    assert [(card.method[:7], card.badge, card.heading) for card in shelf.items] == [
        ("mine </", "worst answer", "turn, panel, frame 3"),
        ("mine </", "no answer", "turn, panel, frame 8"),
        ("outside", "worst answer", "turn, panel, frame 5"),
        ("outside", "no answer", "turn, panel, frame 6"),
    ]
    assert [card.kinds for card in shelf.items] == [("true", "answered"), ("true",)] * 2
    assert shelf.items[1].reason == HOSTILE
    assert shelf.items[3].reason == ""
    assert [card.is_wrong for card in shelf.items] == [True, False, True, False]


def test_the_answered_outline_is_the_true_one_where_the_answer_is_and_turns_with_it(folder: Path, index: Results) -> None:
    frames = pool(folder, index)
    exact = frames[(frames["method"] == "outside") & (frames["frame"] == 10)]
    (shelf,) = gallery(folder, index, exact, ["outside"]).shelves
    true, answered = shelf.items[0].views[0].shapes
    assert true.path == answered.path
    (shelf,) = _gallery(folder, index).shelves
    true, answered = shelf.items[0].views[0].shapes
    corners = [np.array(re.findall(r"[-\d.]+,[-\d.]+", one.path)) for one in (true, answered)]
    assert (corners[0] != corners[1]).any()


def test_a_damaged_frame_and_a_data_set_that_is_not_there_are_left_out(folder: Path, index: Results, tmp_path: Path) -> None:
    gone = index.model_copy(update={"entries": tuple(one.model_copy(update={"dataset": "gone"}) for one in index.entries)})
    shown = _gallery(folder, gone)
    assert not shown
    assert shown.missing == 4
    assert _page(shown).strip() == ""


def test_what_methods_say_stays_text(folder: Path, index: Results) -> None:
    page = _page(_gallery(folder, index))
    parser = _Tags()
    parser.feed(page)
    assert parser.open == []
    assert not [tag for tag, attributes in parser.tags if tag == "img" and not (attributes["src"] or "").startswith("data:image/")]
    assert not [name for _, attributes in parser.tags for name in attributes if name.startswith("on")]
    assert "{{ 7*7 }}" in page
    assert "http" not in page


def test_every_control_has_a_label_and_every_picture_a_text(folder: Path, index: Results) -> None:
    parser = _Tags()
    parser.feed(_page(_gallery(folder, index)))
    figures = [attributes for tag, attributes in parser.tags if tag == "svg" and attributes.get("role") == "img"]
    assert len(figures) == 4
    assert all(attributes["aria-label"] for attributes in figures)
    ids = [attributes["id"] for _, attributes in parser.tags if "id" in attributes]
    assert len(ids) == len(set(ids))
    names = {attributes["name"] for tag, attributes in parser.tags if tag == "input" and attributes["type"] == "radio"}
    assert len(names) <= 4  # a group a card


def test_the_bytes_are_bounded(folder: Path, index: Results, monkeypatch: pytest.MonkeyPatch) -> None:
    (whole,) = _gallery(folder, index).shelves
    monkeypatch.setattr(report_gallery, "MOST_BYTES", sum(card.size for card in whole.items) - 1)
    (cut,) = _gallery(folder, index).shelves
    assert len(cut.items) == 3
    assert {card.badge for card in cut.items if card.method == "outside"} == {"worst answer"}  # the last turn was not reached


def test_the_command_names_the_library_scenario_with_what_differs(make_dataset: Callable[..., Dataset], dataset: Dataset) -> None:
    def manifest(scenario: str, *overrides: str) -> Any:
        plain = load_scenario(scenario, overrides).model_dump(mode="json")
        return dataset.manifest.model_copy(update={"scenario": plain, "seed": 7, "quality": {"name": "draft"}})

    plain = command(manifest("zhai2014-in-plane"), 12, "fly")
    assert plain == "hardlight render zhai2014-in-plane --seed 7 --frames 12:13 --quality draft --out fly-12"
    changed = command(manifest("zhai2014-in-plane", "motion.range_m=50.0"), 3, "fly")
    assert (
        changed == "hardlight render zhai2014-in-plane --set motion.range_m=50.0 --seed 7 --frames 3:4 --quality draft --out fly-3"
    )
    assert command(dataset.manifest, 4, "turn") == "hardlight render turn.toml --seed 0 --frames 4:5 --quality draft --out turn-4"
    assert gallery_command.command(dataset.manifest, 4, "a b; rm").endswith("--out 'a b; rm-4'")
