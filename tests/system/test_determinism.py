"""The same scenario, seed, backend and versions give the same bytes, whoever renders them, in whatever order, through kills."""

import hashlib
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from renderer.again import cannot_compare, rerender
from scenes.dataset import Dataset
from scenes.dataset_verify import verify

FRAMES = "0:720:18"
COUNT = 40


def hardlight_render(out: Path, *more: str, frames: str = FRAMES) -> list[str]:
    command = [sys.executable, "-m", "benchmark.cli", "render", "zhai2014-out-of-plane", "--out", str(out), "--frames", frames]
    return [*command, "--set", "quality=fast", "--quiet", *more]


def contents(folder: Path) -> dict[str, str]:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture(scope="module")
def one_worker(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("data") / "one"
    subprocess.run(hardlight_render(out), check=True)
    return out


def test_the_data_set_is_whole(one_worker):
    assert verify(one_worker) == []
    assert len(Dataset.open(one_worker).frames) == COUNT


@pytest.mark.slow
def test_three_workers_write_the_same_bytes(one_worker, tmp_path):
    subprocess.run(hardlight_render(tmp_path / "three", "--workers", "3"), check=True)
    assert contents(tmp_path / "three") == contents(one_worker)


@pytest.mark.slow
def test_a_frame_rendered_alone_has_the_same_bytes(one_worker, tmp_path):
    subprocess.run(hardlight_render(tmp_path / "alone", frames="144:145"), check=True)
    alone, whole = contents(tmp_path / "alone" / "frames"), contents(one_worker / "frames")
    assert len(alone) == 3
    assert alone == {name: digest for name, digest in whole.items() if name.startswith("000144/")}


def test_frames_rendered_again_are_equal_bit_by_bit(one_worker):
    dataset = Dataset.open(one_worker)
    assert cannot_compare(dataset) == ""
    assert dict(rerender(dataset, [216, 0])) == {216: [], 0: []}


def published(out: Path) -> int:
    return len(list((out / "frames").glob("[0-9]*")))


@pytest.mark.slow
def test_killed_ten_times_and_resumed_gives_the_same_bytes(one_worker, tmp_path):
    """SIGKILL at random moments while frames are being made; what was published stays, what was not leaves no trace."""
    out, moments = tmp_path / "killed", random.Random(7)
    for _ in range(10):
        before = published(out)
        run = subprocess.Popen(hardlight_render(out, "--resume"), start_new_session=True)
        while published(out) == before and run.poll() is None:
            time.sleep(0.02)
        time.sleep(moments.uniform(0, 0.5))
        assert run.poll() is None, "the run was over before it could be killed"
        os.killpg(run.pid, signal.SIGKILL)
        run.wait()
    subprocess.run(hardlight_render(out, "--resume"), check=True)
    assert contents(out) == contents(one_worker)


def test_another_seed_gives_another_picture_and_is_refused_in_the_same_folder(one_worker, tmp_path):
    done = subprocess.run(hardlight_render(one_worker, "--resume", "--seed", "1"), capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "seed" in done.stderr
    assert "Traceback" not in done.stderr
    subprocess.run(hardlight_render(tmp_path / "other", "--seed", "1", frames="0:1"), check=True)
    assert contents(tmp_path / "other")["frames/000000/nav.png"] != contents(one_worker)["frames/000000/nav.png"]
