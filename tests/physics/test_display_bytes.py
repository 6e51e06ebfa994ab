"""Frames of a display are the same bytes alone and in a row, again, by several processes, and nearly so without LLVM."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from oracles.monitor import photographs, plate

from renderer.again import cannot_compare, rerender
from renderer.generate import generate
from renderer.variant import activate
from scenes.dataset import Dataset
from scenes.dataset_verify import verify
from scenes.scenario import Scenario

ALONE = """
import sys, numpy as np
from renderer.photograph import Photographer
from scenes.scenario import Scenario, realize
case = Scenario.model_validate_json(sys.stdin.read())
photo = Photographer(case, "cam").take(realize(case, 0, 1))
np.savez(sys.argv[1], pixels=photo.pixels, **photo.layers)
"""


@pytest.fixture(scope="module")
def case() -> Scenario:
    """With noise, a grid, smoothing and a tilt."""
    noise = {"shot_noise": True, "read_noise_e": 5.0, "prnu": 0.01, "psf_sigma_px": 0.5}
    base = plate("y", -20.0, tilt_deg=(1.0, 2.0, 0.0), fill_factor=0.8, anti_aliasing=4).model_dump(mode="json")
    base["cameras"]["cam"]["detector"] |= noise
    return Scenario.model_validate(base | {"quality": "draft"})


@pytest.fixture(scope="module")
def in_a_row(case: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Frames 0 to 3 by one process."""
    out = tmp_path_factory.mktemp("data") / "row"
    generate(case, out, frames=range(4))
    return out


def contents(folder: Path) -> dict[str, str]:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def test_a_frame_alone_is_the_frame_in_a_row(case: Scenario, in_a_row: Path, tmp_path: Path):
    generate(case, tmp_path / "alone", frames=range(2, 3))
    alone, row = contents(tmp_path / "alone" / "frames"), contents(in_a_row / "frames")
    assert len(alone) == 3
    assert alone == {name: digest for name, digest in row.items() if name.startswith("000002/")}


def test_the_data_set_is_whole_and_made_again_bit_by_bit(in_a_row: Path):
    assert verify(in_a_row) == []
    dataset = Dataset.open(in_a_row)
    assert cannot_compare(dataset) == ""
    assert dict(rerender(dataset, [3, 0])) == {3: [], 0: []}
    truth = dataset.truth(1).sensor_from_target["cam"]
    assert truth.translation == pytest.approx([0.0, 0.0, 100.0])


@pytest.mark.slow
def test_two_processes_write_the_same_bytes(case: Scenario, in_a_row: Path, tmp_path: Path):
    generate(case, tmp_path / "two", frames=range(4), workers=2)
    assert contents(tmp_path / "two") == contents(in_a_row)


@pytest.mark.slow
def test_without_llvm_the_same_picture_comes_out(case: Scenario, tmp_path: Path):
    if activate().is_scalar:
        pytest.skip("nothing to compare with: this machine has no LLVM that works")
    photo = photographs(case, [1])[0]
    environment = os.environ | {"DRJIT_LIBLLVM_PATH": "/nonexistent.so", "HARDLIGHT_CACHE": str(tmp_path)}
    command = [sys.executable, "-c", ALONE, str(tmp_path / "scalar.npz")]
    done = subprocess.run(
        command, input=case.model_dump_json(), env=environment, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    with np.load(tmp_path / "scalar.npz") as stored:
        scalar = dict(stored)
    assert scalar.keys() == photo.layers.keys() | {"pixels"}
    for name, layer in photo.layers.items():
        assert scalar[name].dtype == layer.dtype
        assert np.isclose(scalar[name], layer, rtol=1e-4, atol=1e-6).mean() > 0.998, name
    assert (np.abs(scalar["pixels"].astype(int) - photo.pixels) <= 1).mean() > 0.998
