"""A small scenario, rendered once through the real command line, and that command line as a function."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from benchmark.cli import main

TINY = """
description = "The fly-around of the paper in a small picture"
frame_count = 6
quality = "draft"
target = "zhai2014-target"

[cameras.nav]
base = "guppy-f125b"
width_px = 640
height_px = 128

[lights]
sun = "sun"

[motion]
type = "axis-sweep"
axis = "y"
start_deg = 20.0
rate_deg_s = 1.0
range_m = 100.0
"""


@dataclass(frozen=True)
class Ended:
    """How a command ended and what it said."""

    status: int
    out: str
    err: str


@pytest.fixture
def hardlight(capsys: pytest.CaptureFixture[str]) -> Callable[..., Ended]:
    """hardlight("verb", ...) runs the command as the console script does, in this process."""

    def run(*arguments: object) -> Ended:
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main([str(one) for one in arguments])
        said = capsys.readouterr()
        assert isinstance(ended.value.code, int)
        return Ended(ended.value.code, said.out, said.err)

    return run


@pytest.fixture(scope="session")
def tiny_scenario(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scenario") / "tiny.toml"
    path.write_text(TINY, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def tiny_dataset(tiny_scenario: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six frames of 640 × 128 px; not to be changed."""
    out = tmp_path_factory.mktemp("data") / "tiny"
    with pytest.raises(SystemExit) as ended:
        main(["render", str(tiny_scenario), "--out", str(out), "--quiet"])
    assert ended.value.code == 0
    return out
