"""What this machine can do: versions, backends, what is missing and the command that installs it."""

import ctypes
import os
import platform
import sys
from dataclasses import dataclass
from importlib import metadata

# Libraries of the operating system that Python packages load but do not bring; package names are Debian's.
_LIBRARIES = {"libatomic.so.1": ("libatomic1", "Dr.Jit, in every variant")}
_DISTRIBUTIONS = (
    "hardlight", "numpy", "scipy", "pydantic", "trimesh", "opencv-python-headless", "OpenEXR", "pandas", "pyarrow",
    "mitsuba", "drjit", "pyoidn", "typer", "rich", "jinja2", "matplotlib",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing looked at: its name, what was found, where it is missing the remedy, and whether nothing works without."""

    name: str
    found: str
    remedy: str = ""
    stops: bool = True

    @property
    def is_missing(self) -> bool:
        """Whether something has to be done."""
        return bool(self.remedy)


def examine() -> list[Finding]:
    """Everything that decides whether a command will work here, in the order in which it matters."""
    return [_machine(), *_packages(), *_libraries(), _backend()]


def _machine() -> Finding:
    name = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"
    return Finding("machine", name)


def _packages() -> list[Finding]:
    findings = []
    for name in _DISTRIBUTIONS:
        try:
            findings.append(Finding(name, metadata.version(name)))
        except metadata.PackageNotFoundError:
            findings.append(Finding(name, "missing", f"{sys.executable} -m pip install {name}"))
    return findings


def _libraries() -> list[Finding]:
    if platform.system() != "Linux":
        return []
    findings = []
    for library, (package, user) in _LIBRARIES.items():
        try:
            ctypes.CDLL(library)
            findings.append(Finding(library, "found"))
        except OSError:
            findings.append(Finding(library, f"missing; needed by {user}", f"apt-get install {package}"))
    return findings


def _backend() -> Finding:
    """The renderer's backend. The slow scalar one works, so its remedy is advice: it is missing speed, not function."""
    from renderer.variant import probe

    backend = probe()
    remedy = "apt-get install libllvm19" if backend.variant.startswith("scalar") else ""
    return Finding("backend", f"{backend.variant}: {backend.reason}", remedy, stops=False)
