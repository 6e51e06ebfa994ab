"""What is kept of results: small, accounted for, whole or not at all, never over something else."""

import json
import shutil
from pathlib import Path

import pytest

from benchmark import archive as archiving
from benchmark import reference, verbs
from benchmark.archive import archive
from benchmark.console import Console
from benchmark.errors import PredictionsError, ResultsConflict
from scenes.dataset import Dataset
from scenes.errors import DatasetError, StorageError
from scenes.provenance import sha256_of_bytes

KEPT = {
    "manifest.json", "results.json", "ranking.json", "report.html", "datasets/panel/manifest.json", "datasets/panel/frames.json",
    *(f"entries/panel/{place}/{name}" for place in (0, 1) for name in ("summary.json", "run.json", "predictions.csv")),
}  # fmt: skip


def _files(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_what_is_small_is_kept_as_it_is_and_the_manifest_accounts_for_all_of_it(out: Path, tmp_path: Path) -> None:
    kept = archive(out, tmp_path / "deep" / "kept")
    files, given = _files(tmp_path / "deep" / "kept"), _files(out)
    assert files.keys() == KEPT
    assert kept.files == {name: sha256_of_bytes(data) for name, data in files.items() if name != "manifest.json"}
    made = {"manifest.json", "datasets/panel/frames.json"}
    assert all(files[name] == given[name] for name in KEPT - made)
    assert reference.read(tmp_path / "deep" / "kept") == kept
    assert list(reference.faults(tmp_path / "deep" / "kept", kept)) == []
    dataset = Dataset.open(out / "datasets/panel")
    assert kept.datasets["datasets/panel"].identity == dataset.identity
    assert kept.title == "Two on a panel"
    assert kept.software["hardlight"]


def test_every_frame_has_a_digest_that_depends_on_each_of_its_files(out: Path, tmp_path: Path) -> None:
    archive(out, tmp_path / "kept")
    digests = json.loads((tmp_path / "kept/datasets/panel/frames.json").read_text())
    assert list(map(int, sorted(digests, key=int))) == Dataset.open(out / "datasets/panel").frames
    frame_json = (out / "datasets/panel/frames/000003/frame.json").read_bytes()
    picture = (out / "datasets/panel/frames/000003/nav.png").read_bytes()
    assert digests["3"] == sha256_of_bytes(frame_json)
    assert sha256_of_bytes(picture) in frame_json.decode()
    assert reference.frame_digests(out / "datasets/panel") == reference.frame_digests(tmp_path / "kept/datasets/panel") == digests


def test_long_tables_of_answers_are_left_out(out: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archiving, "LARGEST_ANSWERS", 10)
    archive(out, tmp_path / "kept")
    assert not list((tmp_path / "kept").rglob("predictions.csv"))


def test_a_library_suites_command_is_in_the_manifest(out: Path, tmp_path: Path) -> None:
    index = json.loads((out / "results.json").read_text())
    text = "The fly-around of Zhai et al. 2014 at the paper's geometry, judged on three rectangles of its target"
    (out / "results.json").write_text(json.dumps(index | {"description": text}))
    assert archive(out, tmp_path / "kept").command == "hardlight bench zhai2014 --out out/zhai2014"


def test_the_same_suites_older_archive_is_replaced_with_nothing_of_it_left(out: Path, tmp_path: Path) -> None:
    kept = tmp_path / "kept"
    archive(out, kept)
    old = kept / "entries/panel/9"
    old.mkdir()
    (old / "summary.json").write_text("[]")
    (out / "report.html").write_text("the new page")
    archive(out, kept)
    assert _files(kept).keys() == KEPT
    assert (kept / "report.html").read_text() == "the new page"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["kept", "out"]


@pytest.mark.parametrize("strange", ["thesis.tex", "entries/panel/0/summary.json.orig", "datasets/panel/frames/000000/frame.json"])
def test_a_folder_with_anything_else_is_refused_and_left_as_it_is(out: Path, tmp_path: Path, strange: str) -> None:
    archive(out, tmp_path / "kept")
    (tmp_path / "kept" / strange).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / "kept" / strange).write_text("mine")
    before = _files(tmp_path / "kept")
    with pytest.raises(ResultsConflict, match=Path(strange).name):
        archive(out, tmp_path / "kept")
    assert _files(tmp_path / "kept") == before


def test_another_suites_archive_a_file_a_link_and_the_results_themselves_are_refused(out: Path, tmp_path: Path) -> None:
    archive(out, tmp_path / "kept")
    index = json.loads((out / "results.json").read_text())
    (out / "results.json").write_text(json.dumps(index | {"title": "Another"}))
    with pytest.raises(ResultsConflict, match="'Two on a panel', not of 'Another'"):
        archive(out, tmp_path / "kept")
    (tmp_path / "file").write_text("mine")
    (tmp_path / "link").symlink_to(tmp_path / "kept")
    (tmp_path / "manifest").mkdir()
    (tmp_path / "manifest/manifest.json").write_text("{}")
    for place in ("file", "link", "out", "manifest"):
        with pytest.raises(ResultsConflict):
            archive(out, tmp_path / place)
    assert (tmp_path / "file").read_text() == "mine"


def test_an_empty_folder_is_taken(out: Path, tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    archive(out, tmp_path / "kept")
    assert _files(tmp_path / "kept").keys() == KEPT


def test_a_disk_that_refuses_leaves_the_older_archive(out: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = tmp_path / "kept"
    archive(out, kept)
    before, write = _files(kept), Path.write_bytes

    def full(path: Path, data: bytes) -> int:
        if path.name == "report.html":
            raise OSError(28, "No space left on device")
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(StorageError, match="No space left"):
        archive(out, kept)
    assert _files(kept) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["kept", "out"]


@pytest.mark.parametrize("field", ["dataset", "answers", "scores"])
@pytest.mark.parametrize("path", ["../elsewhere", "/etc", ".", "entries/../../x"])
def test_an_index_that_points_out_of_its_folder_is_refused(out: Path, tmp_path: Path, field: str, path: str) -> None:
    index = json.loads((out / "results.json").read_text())
    index["entries"][0][field] = path
    (out / "results.json").write_text(json.dumps(index))
    with pytest.raises(PredictionsError, match="only the --out folder of hardlight bench"):
        archive(out, tmp_path / "kept")
    assert not (tmp_path / "kept").exists()


def test_incomplete_results_are_refused(out: Path, tmp_path: Path) -> None:
    shutil.rmtree(out / "datasets/panel/frames/000003")
    with pytest.raises(DatasetError, match="000003"):
        archive(out, tmp_path / "kept")


def test_summaries_of_another_data_set_are_refused(out: Path, tmp_path: Path) -> None:
    path = out / "entries/panel/0/summary.json"
    path.write_text(path.read_text().replace(Dataset.open(out / "datasets/panel").identity, "0" * 64))
    with pytest.raises(PredictionsError, match="is of data set 000000000000"):
        archive(out, tmp_path / "kept")


def test_report_says_that_an_archive_has_no_data_sets_and_keeps_its_page(out: Path, tmp_path: Path) -> None:
    archive(out, tmp_path / "kept")
    with pytest.raises(PredictionsError, match=r"without data sets.*report\.html.*left as it is"):
        verbs.report(tmp_path / "kept", Console(quiet=True))
    assert _files(tmp_path / "kept")["report.html"] == _files(out)["report.html"]
