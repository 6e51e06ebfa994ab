"""The choice of a backend: trials in their own process, remembered verdicts, and one sentence that says why."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from renderer import variant
from renderer.variant import _llvm_version, probe

PROBE = "import json, dataclasses; from renderer.variant import probe; print(json.dumps(dataclasses.asdict(probe())))"
OLD_LLVM = sorted(Path("/usr/lib").glob("*-linux-gnu/libLLVM-1[45].so.1"))


def _probed(llvm: str, cache: Path) -> dict[str, str | None]:
    environment = os.environ | {"DRJIT_LIBLLVM_PATH": llvm, "HARDLIGHT_CACHE": str(cache)}
    done = subprocess.run([sys.executable, "-c", PROBE], env=environment, capture_output=True, text=True, check=True, timeout=150)
    found: dict[str, str | None] = json.loads(done.stdout)
    return found


def test_without_llvm_it_falls_back_and_says_why(tmp_path: Path):
    found = _probed("/nonexistent.so", tmp_path)
    if found["variant"] == "cuda_ad_mono":
        pytest.skip("a GPU renders here")
    assert found["variant"] == "scalar_rgb"
    assert found["llvm_path"] is None
    assert found["reason"] == ("falling back to the slow scalar_rgb, because llvm_ad_mono with /nonexistent.so: no such file")


def test_a_file_that_is_no_llvm_is_rejected_by_the_trial(tmp_path: Path):
    fake = tmp_path / "libLLVM.so"
    fake.write_bytes(b"not a library")
    found = _probed(str(fake), tmp_path)
    if found["variant"] == "cuda_ad_mono":
        pytest.skip("a GPU renders here")
    assert found["variant"] == "scalar_rgb"
    assert str(fake) in str(found["reason"])
    verdicts = json.loads((tmp_path / "hardlight" / "backends.json").read_text())
    assert len(verdicts) == 1
    assert next(iter(verdicts)).startswith(f"llvm_ad_mono|{fake}|")


@pytest.mark.skipif(not OLD_LLVM, reason="no LLVM 14 or 15 on this machine")
@pytest.mark.parametrize("llvm", OLD_LLVM, ids=lambda path: path.name)
def test_an_llvm_that_aborts_the_process_is_tried_elsewhere(llvm: Path, tmp_path: Path):
    # LLVM 15 cannot select fminimum on AVX-512 and ends the process; on other machines it may well work.
    found = _probed(str(llvm), tmp_path)
    if found["variant"] == "llvm_ad_mono":
        pytest.skip("this LLVM works here")
    assert found["variant"] in ("scalar_rgb", "cuda_ad_mono")
    verdict = next(iter(json.loads((tmp_path / "hardlight" / "backends.json").read_text()).values()))
    assert verdict
    assert str(verdict) in str(found["reason"])


@pytest.fixture
def candidates(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[tuple[str, str | None]]:
    """Two LLVM libraries of which the first aborts; every trial that is really made is noted."""
    files = [tmp_path / "libLLVM-20.so", tmp_path / "libLLVM-19.so"]
    for file in files:
        file.write_bytes(b"x")
    tried: list[tuple[str, str | None]] = []

    def trial(name: str, llvm: str | None) -> str | None:
        tried.append((name, llvm))
        return "aborts the process (boom)" if llvm == str(files[0]) else None

    monkeypatch.setenv("HARDLIGHT_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    monkeypatch.setattr(variant, "_has_nvidia_driver", lambda: False)
    monkeypatch.setattr(variant, "_installed_llvm", lambda: files)
    monkeypatch.setattr(variant, "_trial", trial)
    return tried


def test_the_first_that_works_is_taken_and_remembered(candidates: list[tuple[str, str | None]], tmp_path: Path):
    first = probe()
    assert first.variant == "llvm_ad_mono"
    assert first.llvm_path == str(tmp_path / "libLLVM-19.so")
    assert not first.is_scalar
    assert probe() == first
    assert len(candidates) == 2  # each once, not again on the second call


def test_a_library_that_was_replaced_is_tried_again(candidates: list[tuple[str, str | None]], tmp_path: Path):
    probe()
    os.utime(tmp_path / "libLLVM-19.so", ns=(1, 1))
    probe()
    assert [llvm for _, llvm in candidates].count(str(tmp_path / "libLLVM-19.so")) == 2


def test_a_broken_or_unwritable_cache_costs_a_trial_and_nothing_else(
    candidates: list[tuple[str, str | None]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    cache = tmp_path / "cache" / "hardlight"
    cache.mkdir(parents=True)
    for content in ("not json", "[1, 2]"):
        (cache / "backends.json").write_text(content)
        assert probe().variant == "llvm_ad_mono"
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("HARDLIGHT_CACHE", str(blocked))
    assert probe().variant == "llvm_ad_mono"
    assert probe().variant == "llvm_ad_mono"


def test_a_gpu_comes_first(candidates: list[tuple[str, str | None]], monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(variant, "_has_nvidia_driver", lambda: True)
    assert probe().variant == "cuda_ad_mono"
    assert candidates == [("cuda_ad_mono", None)]


def test_the_users_word_is_final(candidates: list[tuple[str, str | None]], monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", str(tmp_path / "libLLVM-20.so"))
    found = probe()
    assert found.is_scalar
    assert "libLLVM-20.so: aborts the process (boom)" in found.reason
    assert "libLLVM-19" not in found.reason


def test_newer_libraries_are_tried_first():
    names = ["libLLVM-14.so.1", "libLLVM.so.19.1", "libLLVM-19.so", "libLLVM-9.so", "libLLVM.so.22.0", "libLLVM-15.so"]
    ordered = [path.name for path in sorted(map(Path, names), key=_llvm_version, reverse=True)]
    assert ordered[0] == "libLLVM.so.22.0"
    assert ordered[-3:] == ["libLLVM-15.so", "libLLVM-14.so.1", "libLLVM-9.so"]
