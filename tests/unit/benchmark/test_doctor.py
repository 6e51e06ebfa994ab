"""The doctor names the remedy for each thing that is missing, and tells what stops the work from what slows it."""

import ctypes
from importlib import metadata

import pytest

from benchmark import doctor
from renderer import variant
from renderer.variant import Backend


def _by_name() -> dict[str, doctor.Finding]:
    return {one.name: one for one in doctor.examine()}


def test_a_whole_machine_has_nothing_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(variant, "probe", lambda: Backend("llvm_ad_mono", "/usr/lib/libLLVM.so", "works"))
    findings = _by_name()
    assert not [one for one in findings.values() if one.is_missing]
    assert findings["backend"].found == "llvm_ad_mono: works"


def test_a_missing_package_stops_and_has_its_command(monkeypatch: pytest.MonkeyPatch) -> None:
    real = metadata.version

    def without_jinja(name: str) -> str:
        if name == "jinja2":
            raise metadata.PackageNotFoundError(name)
        return real(name)

    monkeypatch.setattr(doctor.metadata, "version", without_jinja)
    finding = _by_name()["jinja2"]
    assert finding.is_missing
    assert finding.stops
    assert finding.remedy.endswith("-m pip install jinja2")


def test_a_missing_system_library_has_its_debian_package(monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing(name: str) -> None:
        raise OSError(f"{name}: cannot open shared object file")

    monkeypatch.setattr(ctypes, "CDLL", nothing)
    monkeypatch.setattr(variant, "probe", lambda: Backend("scalar_rgb", None, "no LLVM library found"))
    findings = _by_name()
    assert findings["libatomic.so.1"].remedy == "apt-get install libatomic1"
    assert findings["libatomic.so.1"].stops


def test_no_llvm_slows_and_does_not_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(variant, "probe", lambda: Backend("scalar_rgb", None, "no LLVM library found"))
    finding = _by_name()["backend"]
    assert finding.is_missing
    assert not finding.stops
    assert "no LLVM library found" in finding.found
