"""What all tests share: a cache of their own, one thread for OpenCV, repeatable examples, and Dr.Jit's memory given back."""

import gc
import os
import signal
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import cv2
import pytest
from hypothesis import settings

settings.register_profile("house", deadline=None, derandomize="CI" in os.environ, print_blob=True)
settings.load_profile("house")

_CACHE = pytest.StashKey[tempfile.TemporaryDirectory]()


def pytest_configure(config: pytest.Config) -> None:
    """Before anything is imported: a cache that no earlier run has filled, drawings without a display, a Ctrl-C that works."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a job in the background ignores it, and so would our children
        signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.setdefault("MPLBACKEND", "Agg")
    if "HARDLIGHT_CACHE" not in os.environ:
        config.stash[_CACHE] = tempfile.TemporaryDirectory(prefix="hardlight-cache-")
        os.environ["HARDLIGHT_CACHE"] = config.stash[_CACHE].name


def pytest_unconfigure(config: pytest.Config) -> None:
    """Takes the cache away again."""
    if _CACHE in config.stash:
        config.stash[_CACHE].cleanup()
        os.environ.pop("HARDLIGHT_CACHE", None)


@pytest.fixture(scope="session", autouse=True)
def _one_opencv_thread() -> Iterator[None]:
    """The renderer keeps all cores busy already, and CPU seconds are measured."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    yield
    cv2.setNumThreads(threads)


@pytest.fixture(scope="module", autouse=True)
def _renderer_memory() -> Iterator[None]:
    """Scenes of one module do not stay for the next: Dr.Jit keeps what it once allocated until it is told otherwise."""
    yield
    if "drjit" in sys.modules:
        gc.collect()
        sys.modules["drjit"].flush_malloc_cache()


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the checkout."""
    return Path(__file__).resolve().parents[1]
