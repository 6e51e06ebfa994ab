"""What the physics tests share: the instruments of ``oracles`` and the paper's scene, loaded once."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # pytest imports tests by file, so the instruments need a place to be found

from oracles.studio import Studio

from scenes.scenario import Scenario, load_scenario


@pytest.fixture(scope="session")
def in_plane() -> Scenario:
    """Case 1 of the paper, moved by 0.069° so that frame 420 shows θ = 0."""
    return load_scenario("zhai2014-in-plane", ["motion.start_deg=-42.0"])


@pytest.fixture(scope="session")
def out_of_plane() -> Scenario:
    """Case 2 of the paper; frame 360 shows θ = 0."""
    return load_scenario("zhai2014-out-of-plane")


@pytest.fixture(scope="session")
def in_plane_studio(in_plane: Scenario) -> Studio:
    """Case 1 at ``standard`` quality, in the product's own window."""
    return Studio.following(in_plane)


@pytest.fixture(scope="session")
def out_of_plane_studio(out_of_plane: Scenario) -> Studio:
    """Case 2 at ``standard`` quality, in the product's own window."""
    return Studio.following(out_of_plane)
