"""What ``hardlight list`` lists: every folder of the library, papers by their titles, and nothing where nothing is."""

from pathlib import Path

import pytest

from benchmark.listing import KINDS, listing
from benchmark.paper_spec import load_papers
from benchmark.verbs import list_
from scenes import config
from scenes.config_files import LIBRARY


def test_every_folder_of_the_library_is_listed() -> None:
    assert {folder.name for folder in LIBRARY.iterdir() if any(folder.glob("*.toml"))} <= set(KINDS)


@pytest.mark.parametrize("kind", KINDS)
def test_names_and_what_they_are(kind: str) -> None:
    found = listing(kind)
    assert [name for name, _ in found] == sorted(name for name, _ in found)
    assert all(text and "\n" not in text for _, text in found)


def test_papers_go_by_their_titles() -> None:
    assert {title for _, title in listing("papers")} == {paper.title for paper in load_papers()}
    assert [name for name, _ in listing("papers")] == ["shu2020", "song2017", "zhai2014"]


class _Tables:
    def __init__(self) -> None:
        self.rows: list[list[dict[str, str]]] = []

    def table(self, title: str, rows: list[dict[str, str]], left: bool) -> None:
        self.rows.append(rows)


@pytest.mark.parametrize("kind", ["studies", "papers", "suites"])
def test_a_kind_of_which_there_is_nothing_is_no_fault(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bare = config.list_library
    monkeypatch.setattr(config, "list_library", lambda asked: bare(asked, tmp_path))
    assert listing(kind) == []
    tables = _Tables()
    list_(kind, tables)  # type: ignore[arg-type]
    assert tables.rows == [[]]
