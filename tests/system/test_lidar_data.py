"""Data sets with LIDARs from the command line: equal bytes whoever scans, verified, beside cameras, refused in one sentence."""

import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from renderer.again import cannot_compare, rerender
from scenes.beam_fate import BeamFate
from scenes.dataset import Dataset

SCENARIO = """
frame_count = 6
rate_hz = 1.0
target = "small-satellite"

[lidars.nav]
base = "song2017-lidar"
pattern = { type = "flash", columns = 48, rows = 48, field_deg = [10.0, 10.0] }

[lidars.raster]
base = "raster-1550"
pattern = { type = "raster", columns = 40, rows = 40, field_deg = [8.0, 8.0], scan_s = 0.5 }
returns = "strongest-and-last"

[motion]
type = "spin"
position_m = [0.0, 0.0, 20.0]
rotation_vector_deg = [160.0, 20.0, 0.0]
omega_target_deg_s = [3.0, 6.0, -2.0]
"""
CAMERA = """
[cameras.cam]
base = "guppy-f125b"
[lights]
sun = "sun"
"""


def hardlight(*words: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "benchmark.cli", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)


def contents(folder: Path) -> dict[str, str]:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture(scope="module")
def scenario(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("scenario") / "spin.toml"
    path.write_text(SCENARIO)
    return path


@pytest.fixture(scope="module")
def rendered(scenario, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("data") / "one"
    done = hardlight("render", scenario, "--out", out)
    assert done.returncode == 0, done.stderr
    assert "6 frames × 2 LIDARs (2,304 + 3,200 points)" in done.stderr
    return out


def test_the_data_set_is_whole_and_its_scans_are_seen(rendered):
    done = hardlight("verify", rendered, "--sample", "2")
    assert done.returncode == 0, done.stdout
    assert "no fault found" in done.stdout
    dataset = Dataset.open(rendered)
    assert dataset.sensors == {}
    seen = dataset.observation(3)
    assert seen.scans["nav"].points_lidar.shape == (48, 48, 3)
    assert seen.scans["raster"].points_lidar.shape == (80, 40, 3)
    assert np.isfinite(seen.scans["nav"].intensity).sum() > 200
    assert dataset.scan_truth(3, "nav")["reason"].shape == (48, 48)
    assert np.ptp(seen.scans["raster"].time_s) == pytest.approx(0.5)


def test_a_beam_without_a_second_return_says_so_and_one_that_meets_nothing_says_that(rendered):
    dataset = Dataset.open(rendered)
    first, second = dataset.scan_truth(3, "raster")["reason"].reshape(2, 40, 40)
    assert np.array_equal(first == BeamFate.NOTHING, second == BeamFate.NOTHING)
    assert {BeamFate.NOTHING, BeamFate.NO_SECOND} <= set(second.ravel())
    assert BeamFate.NO_SECOND not in first
    told = {name: one["reasons"].get("no_second") for name, one in dataset.manifest.lidars.items()}
    assert told == {"nav": None, "raster": BeamFate.NO_SECOND}


def test_frames_scanned_again_are_equal_bit_by_bit(rendered):
    dataset = Dataset.open(rendered)
    assert cannot_compare(dataset) == ""
    assert [faults for _, faults in rerender(dataset, [5, 2])] == [[], []]


@pytest.mark.slow
def test_two_workers_write_the_same_bytes(scenario, rendered, tmp_path):
    done = hardlight("render", scenario, "--out", tmp_path / "two", "--workers", "2")
    assert done.returncode == 0, done.stderr
    assert contents(tmp_path / "two") == contents(rendered)


def test_a_frame_scanned_alone_and_one_after_resuming_have_the_same_bytes(scenario, rendered, tmp_path):
    assert hardlight("render", scenario, "--out", tmp_path / "alone", "--frames", "4").returncode == 0
    alone, whole = contents(tmp_path / "alone" / "frames"), contents(rendered / "frames")
    assert len(alone) == 5
    assert alone == {name: digest for name, digest in whole.items() if name.startswith("000004/")}


def test_a_damaged_scan_is_found(rendered, tmp_path):
    copy = tmp_path / "copy"
    subprocess.run(["cp", "-r", str(rendered), str(copy)], check=True)
    file = copy / "frames" / "000002" / "nav.pcd"
    file.write_bytes(file.read_bytes()[:-1])
    done = hardlight("verify", copy, "--sample", "0")
    assert done.returncode == 1
    assert "nav.pcd: its digest is" in done.stdout


@pytest.mark.slow
def test_cameras_and_lidars_share_one_truth(tmp_path):
    path = tmp_path / "both.toml"
    path.write_text(SCENARIO + CAMERA)
    done = hardlight("render", path, "--out", tmp_path / "both", "--frames", "0:2", "--quality", "draft", "--workers", "1")
    assert done.returncode == 0, done.stderr
    assert "2 frames × 1 camera and 2 LIDARs" in done.stderr
    dataset = Dataset.open(tmp_path / "both")
    seen = dataset.observation(1)
    assert (seen.images.keys(), seen.scans.keys()) == ({"cam"}, {"nav", "raster"})
    truth = dataset.truth(1)
    difference = truth.sensor_from_target["cam"] * truth.sensor_from_target["raster"].inv()
    assert difference.as_matrix() == pytest.approx(np.eye(4), abs=1e-12)
    assert len(dataset.truth_table()) == 6
    assert hardlight("verify", tmp_path / "both").returncode == 0


def test_the_library_s_lidars_are_listed():
    done = hardlight("list", "lidars")
    assert done.returncode == 0
    assert "song2017-lidar" in done.stdout


def test_a_lidar_that_looks_away_is_refused_in_one_sentence(scenario, tmp_path):
    away = "lidars.nav.mount.rotation_vector_deg=[0.0, 90.0, 0.0]"
    done = hardlight("render", scenario, "--out", tmp_path / "away", "--set", away)
    assert done.returncode == 2
    assert "lidars.nav: in none of the 6 frames" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "away").exists()
