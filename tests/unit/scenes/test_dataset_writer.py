"""A frame exists whole or not at all: through kills, several writers and a full disk; nobody's folder is overwritten."""

import errno
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenes import atomic
from scenes.dataset_verify import verify
from scenes.dataset_writer import DatasetWriter, frame_files
from scenes.errors import AssetError, DatasetConflict, DatasetError, StorageError

KILLS = 10
PROGRAM = Path(__file__).with_name("tiny_dataset.py")


@pytest.fixture(scope="module")
def start():
    """Starts a writer process: ``start(path, part, parts)`` → its number."""
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, str(PROGRAM)], env=environment, **pipes) as server:

        def started(path, part=0, parts=1):
            server.stdin.write(f"{path} {part} {parts}\n")
            server.stdin.flush()
            return int(server.stdout.readline())

        yield started
        server.stdin.close()


def is_running(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def wait(process):
    while is_running(process):
        time.sleep(0.001)


def test_the_same_frames_give_the_same_bytes(tiny, dataset_path, tmp_path):
    writer = DatasetWriter.open(tmp_path / "backward", tiny.manifest())
    for frame in reversed(writer.missing()):
        writer.write(tiny.record(frame))
    writer.finish()
    assert tiny.content(tmp_path / "backward") == tiny.content(dataset_path)


def test_killed_ten_times_and_resumed_gives_the_same_bytes(tiny, dataset_path, tmp_path, start):
    """SIGKILL at random moments while frames are written; whatever is published after each kill is whole."""
    path, chance, whole = tmp_path / "killed", random.Random(0), tiny.content(dataset_path)
    killed, left_half_written = 0, 0
    while killed < KILLS:
        writer = start(path)
        while is_running(writer) and not any(path.glob(f"frames/.tmp-{writer}-*")):
            time.sleep(0.0002)  # until it writes its first frame
        time.sleep(chance.uniform(0, 0.01))
        if is_running(writer):
            os.kill(writer, signal.SIGKILL)
            killed += 1
        wait(writer)
        there = tiny.content(path)
        left_half_written += any(f".tmp-{writer}" in name for name in there)
        assert all(whole[name] == data for name, data in there.items() if ".tmp-" not in name)
        if sum(name.endswith("frame.json") for name in there) > 6:  # leave something to be killed at
            (path / "truth.parquet").unlink(missing_ok=True)
            for frame in (3, 9, 11, 15, 17):
                shutil.rmtree(path / f"frames/{frame:06d}", ignore_errors=True)
    assert left_half_written >= 1  # otherwise all kills came at moments that prove nothing; how many is up to the machine
    tiny.write(path, resume=True)
    assert tiny.content(path) == whole


def test_three_processes_write_one_data_set(tiny, dataset_path, tmp_path, start):
    path = tmp_path / "shared"
    DatasetWriter.open(path, tiny.manifest())
    for writer in [start(path, part, 3) for part in range(3)]:
        wait(writer)
    writer = DatasetWriter.open(path, tiny.manifest(), resume=True)
    assert writer.missing() == []
    writer.finish()
    assert tiny.content(path) == tiny.content(dataset_path)


def test_two_writers_of_the_same_frame_agree(tiny, tmp_path):
    first, second = (DatasetWriter.open(tmp_path / "set", tiny.manifest(), resume=True) for _ in range(2))
    first.write(tiny.record(5))
    before = tiny.content(tmp_path / "set")
    second.write(tiny.record(5))
    assert tiny.content(tmp_path / "set") == before


def test_missing_and_finish(tiny, tmp_path):
    writer = DatasetWriter.open(tmp_path / "set", tiny.manifest())
    writer.write(tiny.record(7))
    assert writer.missing() == [3, 5, *range(9, 23, 2)]
    with pytest.raises(DatasetError, match=r"9 of 10 frames are missing \(000003, 000005, .*\.\.\.\); render them with --resume"):
        writer.finish()
    assert not (tmp_path / "set/truth.parquet").exists()
    with pytest.raises(ValueError, match="frame 4 is not one of"):
        writer.write(tiny.record(4))


def test_a_frame_is_a_function_of_its_record(tiny, dataset_path):
    """What stands on disk can be compared byte by byte with what is made again."""
    for frame in tiny.manifest().selected:
        folder = dataset_path / f"frames/{frame:06d}"
        assert frame_files(tiny.manifest(), tiny.record(frame)) == tiny.content(folder)


@pytest.mark.parametrize("what", ["images", "layers", "truth"])
def test_a_frame_without_one_of_its_sensors_is_refused(tiny, tmp_path, what):
    writer = DatasetWriter.open(tmp_path / "set", tiny.manifest())
    record = tiny.record(3)
    one = {"nav": getattr(record, what)["nav"]}
    with pytest.raises(ValueError, match=r"has the sensors \['nav'\], the manifest \['nav', 'wide'\]"):
        writer.write(replace(record, **{what: one}))
    assert writer.missing()[0] == 3


@pytest.mark.parametrize("pixels", [np.zeros((4, 4, 3), np.uint8), np.zeros((4, 4)), np.zeros((4, 4), np.int16)])
def test_what_is_no_picture_is_refused(tiny, tmp_path, pixels):
    writer = DatasetWriter.open(tmp_path / "set", tiny.manifest())
    with pytest.raises(ValueError, match="a picture is"):
        writer.write(replace(tiny.record(3), images={"nav": pixels, "wide": pixels}))


def test_an_equal_data_set_needs_resume(tiny, dataset_path):
    before = tiny.content(dataset_path)
    with pytest.raises(DatasetConflict, match="holds this data set already; go on with --resume"):
        DatasetWriter.open(dataset_path, tiny.manifest())
    assert DatasetWriter.open(dataset_path, tiny.manifest(), resume=True).missing() == []
    assert tiny.content(dataset_path) == before


@pytest.mark.parametrize("resume", [False, True])
@pytest.mark.parametrize(
    ("changes", "text"),
    [
        (
            {"scenario": {"rate_hz": 3.0}},
            r"digest: \w{64} in the folder, \w{64} asked for; scenario.rate_hz: 2.0 in the folder, 3.0",
        ),
        ({"seed": 8}, "seed: 7 in the folder, 8 asked for"),
        ({"frames": range(3, 22)}, r"frames: \[3,23,2\] in the folder, \[3,22,1\] asked for"),
        ({"backend": {"variant": "scalar_rgb", "llvm": None}}, "backend.variant: llvm_ad_rgb in the folder, scalar_rgb asked for"),
        ({"software": {"hardlight": "0.1", "python": "3"}}, "software.hardlight: 0.0 in the folder, 0.1 asked for"),
        ({"quality": "standard"}, 'quality: {"name":"fast","spp":16} in the folder, standard asked for'),
    ],
)
def test_another_data_set_is_refused_with_both_values(tiny, dataset_path, changes, text, resume):
    before = tiny.content(dataset_path)
    with pytest.raises(DatasetConflict, match=text) as caught:
        DatasetWriter.open(dataset_path, tiny.manifest(**changes), resume=resume)
    assert caught.value.exit_status == 2
    assert tiny.content(dataset_path) == before


def test_a_folder_that_is_no_data_set_is_left_alone(tiny, tmp_path):
    (tmp_path / "thesis.tex").write_text("precious")
    with pytest.raises(DatasetConflict, match=r"is no data set and not empty \(it has 'thesis.tex'\)"):
        DatasetWriter.open(tmp_path, tiny.manifest(), resume=True)
    assert tiny.content(tmp_path) == {"thesis.tex": b"precious"}
    with pytest.raises(DatasetConflict, match="is a file, not a folder"):
        DatasetWriter.open(tmp_path / "thesis.tex", tiny.manifest())


def test_an_empty_folder_and_the_remains_of_a_killed_start_are_taken(tiny, tmp_path):
    stale = tmp_path / ".tmp-999999999-manifest.json"  # above any process number of Linux
    stale.write_text("{")
    DatasetWriter.open(tmp_path, tiny.manifest())
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["frames", "manifest.json"]


def test_open_removes_what_dead_processes_left_and_nothing_of_living_ones(tiny, tmp_path):
    path = tmp_path / "set"
    DatasetWriter.open(path, tiny.manifest())
    dead, alive = path / "frames/.tmp-999999999-000003", path / f"frames/.tmp-{os.getppid()}-000005"
    for folder in (dead, alive):
        folder.mkdir()
        (folder / "nav.png").write_bytes(b"half")
    writer = DatasetWriter.open(path, tiny.manifest(), resume=True)
    assert (dead.exists(), alive.exists()) == (False, True)
    assert writer.missing()[0] == 3
    for frame in writer.missing():
        writer.write(tiny.record(frame))
    writer.finish()  # every frame is there: whatever is half-written is of no use to anybody
    assert verify(path) == []


@pytest.mark.parametrize("nth", range(1, 7))
def test_a_disk_that_fills_up_leaves_nothing_half_written(tiny, tmp_path, monkeypatch, nth):
    """ENOSPC at each step of a frame: four files, its folder, the folder of all frames."""
    path = tmp_path / "set"
    writer = DatasetWriter.open(path, tiny.manifest())
    writer.write(tiny.record(3))
    before, sync, calls = tiny.content(path), os.fsync, []

    def full(descriptor):
        calls.append(descriptor)
        if len(calls) == nth:
            raise OSError(errno.ENOSPC, "No space left on device")
        sync(descriptor)

    monkeypatch.setattr(atomic.os, "fsync", full)
    with pytest.raises(StorageError, match=r"the disk is full: .*000005 was not written; .*--resume, nothing is lost"):
        writer.write(tiny.record(5))
    monkeypatch.undo()
    assert tiny.content(path) == before
    assert 5 in writer.missing()
    tiny.write(path, resume=True)
    assert verify(path) == []


@contextmanager
def small_disk(folder, size):
    """A real file system of ``size``; the test is skipped where mounting is not allowed."""
    folder.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)], capture_output=True, check=False)
    if done.returncode:
        pytest.skip("mounting a file system is not allowed here")
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def test_a_real_full_disk_keeps_what_was_complete(tiny, dataset_path, tmp_path):
    with small_disk(tmp_path / "disk", "64k") as disk:
        with pytest.raises(StorageError, match="the disk is full"):
            tiny.write(disk / "set")
        whole, there = tiny.content(dataset_path), tiny.content(disk / "set")
        assert len(there) > 1
        assert all(whole[name] == data for name, data in there.items())
        subprocess.run(["mount", "-o", "remount,size=4m", str(disk)], check=True)
        tiny.write(disk / "set", resume=True)
        assert tiny.content(disk / "set") == whole


def test_other_refusals_of_the_disk_are_sentences(tiny, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StorageError, match=r"cannot write .*file/set: Not a directory"):
        DatasetWriter.open(tmp_path / "file/set", tiny.manifest())


def mesh_scenario(path):
    return {"target": {"parts": [{"shape": {"type": "mesh", "path": str(path), "scale": 0.001}}]}}


def test_meshes_travel_with_the_data_set(tiny, tmp_path):
    """The digest follows the mesh's content, not its place."""
    import trimesh

    from scenes.assets import load_mesh
    from scenes.dataset import Dataset

    for folder, size in (("a", 1), ("b", 1), ("c", 2)):
        (tmp_path / folder).mkdir()
        trimesh.creation.box((size, 1, 1)).export(tmp_path / folder / "part.stl")
    one, same, other = (tiny.manifest(scenario=mesh_scenario(tmp_path / folder / "part.stl")) for folder in "abc")
    assert one.identity == same.identity
    assert one.digest != other.digest
    writer = DatasetWriter.open(tmp_path / "set", one)
    shutil.rmtree(tmp_path / "a")
    for frame in writer.missing():
        writer.write(tiny.record(frame))
    writer.finish()
    assert verify(tmp_path / "set") == []
    shape = Dataset.open(tmp_path / "set").scenario["target"]["parts"][0]["shape"]
    assert len(load_mesh(Path(shape["path"]), shape["scale"]).faces) == 12
    Path(shape["path"]).write_bytes(b"solid other")
    (fault,) = verify(tmp_path / "set")
    assert "it was truncated or edited" in fault


def test_a_mesh_changed_at_the_wrong_moment_is_refused(tiny, tmp_path):
    file = tmp_path / "part.stl"
    file.write_bytes(b"solid a")
    manifest = tiny.manifest(scenario=mesh_scenario(file))
    file.write_bytes(b"solid b")
    with pytest.raises(AssetError, match="was changed while it was used"):
        DatasetWriter.open(tmp_path / "set", manifest)
