"""What the tests of the vocabulary share."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(scope="session")
def tiny() -> ModuleType:
    """The module tiny_dataset: made-up frames."""
    spec = importlib.util.spec_from_file_location("tiny_dataset", Path(__file__).with_name("tiny_dataset.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def dataset_path(tiny: ModuleType, tmp_path: Path) -> Path:
    """A complete data set of ten frames and two cameras."""
    path = tmp_path / "set"
    tiny.write(path)
    return path
