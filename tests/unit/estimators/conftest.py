"""What the estimators' tests share: the toy renderer's sweeps, drawn once."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # pytest imports tests by file, so the toy needs a place to be found

from toy_sweep import Sweep


@pytest.fixture(scope="session")
def in_plane() -> Sweep:
    """The paper's case 1: 41 frames, 2.1° and 21 s apart."""
    return Sweep.drawn(case=1, first_deg=-41.931, last_deg=41.931, frames=41)


@pytest.fixture(scope="session")
def out_of_plane() -> Sweep:
    """The paper's case 2: 41 frames, 1.8° and 18 s apart."""
    return Sweep.drawn(case=2, first_deg=-36.0, last_deg=36.0, frames=41)


@pytest.fixture(scope="session")
def dense() -> list[Sweep]:
    """100 frames of case 1 at 1 Hz, -30° to -20°, with three noises."""
    return Sweep.redrawn(case=1, first_deg=-30.0, last_deg=-20.1, frames=100, seeds=(1, 2, 3))
