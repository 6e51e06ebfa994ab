"""Chooses the Mitsuba variant: the only place that calls ``set_variant``.

Some LLVM libraries make Dr.Jit abort the whole process, so each candidate is tried in a subprocess with a kernel that holds
what they fail on (min/max), newest first; the verdict is cached beside the user's other caches.
"""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path

_ENVIRONMENT = "DRJIT_LIBLLVM_PATH"
_PREFERRED = ("cuda_ad_mono", "llvm_ad_mono")
_FALLBACK = "scalar_rgb"  # Mitsuba ships no scalar mono; all three channels carry the same number
_TRIAL_SECONDS = 120
_TRIAL = """
import sys, mitsuba as mi
mi.set_variant(sys.argv[1])
import drjit as dr
x = dr.arange(mi.Float, 64)
y = dr.maximum(dr.minimum(x, 31.5), 2.5) + dr.fma(x, x, 1.0)
s = mi.load_dict({"type": "scene", "shape": {"type": "sphere"}})
hit = s.ray_intersect(mi.Ray3f(mi.Point3f(0, 0, -5), mi.Vector3f(0, 0, 1) + 0 * x)).t
dr.eval(y, hit)
assert abs(dr.sum(hit)[0] - 64 * 4) < 1e-2
"""


@dataclass(frozen=True, slots=True)
class Backend:
    """What renders here: the Mitsuba variant, the LLVM library it needs (or None), and why it was chosen."""

    variant: str
    llvm_path: str | None
    reason: str

    @property
    def is_scalar(self) -> bool:
        """Whether rays are traced one by one (no LLVM, no GPU)."""
        return self.variant.startswith("scalar")


def probe() -> Backend:
    """The best backend of this machine: GPU, then LLVM, then scalar, with the reason in one sentence."""
    rejected: list[str] = []
    for variant, llvm_path in _candidates():
        fault = _cached_trial(variant, llvm_path)
        if fault is None:
            return Backend(variant, llvm_path, f"{variant} works" + (f" with {llvm_path}" if llvm_path else ""))
        rejected.append(f"{variant}{f' with {llvm_path}' if llvm_path else ''}: {fault}")
    why = "; ".join(rejected) or "no LLVM library found (on Debian: apt-get install libllvm19)"
    return Backend(_FALLBACK, None, f"falling back to the slow {_FALLBACK}, because {why}")


@cache
def activate() -> Backend:
    """Probes once, sets Mitsuba's variant for this process, and says which."""
    backend = probe()
    if backend.llvm_path:
        os.environ[_ENVIRONMENT] = backend.llvm_path
    import mitsuba as mi

    mi.set_variant(backend.variant)
    return backend


def _candidates() -> Iterator[tuple[str, str | None]]:
    if _has_nvidia_driver():
        yield _PREFERRED[0], None
    wanted = os.environ.get(_ENVIRONMENT)
    paths = [Path(wanted)] if wanted else _installed_llvm()  # the user's word is final, also when it is wrong
    for path in paths:
        yield _PREFERRED[1], str(path)


def _has_nvidia_driver() -> bool:
    return Path("/proc/driver/nvidia/version").exists()


def _installed_llvm() -> list[Path]:
    """Every LLVM library in the usual places, newest first, each once."""
    folders = [Path("/usr/lib"), Path("/usr/local/lib"), Path("/opt/homebrew/opt/llvm/lib"), Path(sys.prefix) / "lib"]
    folders += sorted(Path("/usr/lib").glob("*-linux-gnu")) + sorted(Path("/usr/lib").glob("llvm-*/lib"))
    found = [p for folder in folders for pattern in ("libLLVM*.so*", "libLLVM*.dylib") for p in folder.glob(pattern)]
    newest_first = sorted(found, key=_llvm_version, reverse=True)
    return list({path.resolve(): None for path in newest_first if path.exists()})


def _llvm_version(path: Path) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", path.name))[:2]


def _cached_trial(variant: str, llvm_path: str | None) -> str | None:
    """The fault of a candidate, or None if it works; remembered per library file and Mitsuba version."""
    if llvm_path and not Path(llvm_path).is_file():
        return "no such file"
    key = _cache_key(variant, llvm_path)
    verdicts = _read_cache()
    if key not in verdicts:
        verdicts[key] = _trial(variant, llvm_path)
        _write_cache(verdicts)
    return verdicts[key]


def _trial(variant: str, llvm_path: str | None) -> str | None:
    environment = dict(os.environ) | ({_ENVIRONMENT: llvm_path} if llvm_path else {})
    command = [sys.executable, "-c", _TRIAL, variant]
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=_TRIAL_SECONDS, check=False
        )
    except subprocess.TimeoutExpired:
        return f"no answer within {_TRIAL_SECONDS} s"
    if done.returncode == 0:
        return None
    last = (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1]
    return f"aborts the process ({last[:200]})" if done.returncode < 0 else last[:200]


def _cache_key(variant: str, llvm_path: str | None) -> str:
    stamp = Path(llvm_path).stat().st_mtime_ns if llvm_path else 0
    return f"{variant}|{llvm_path}|{stamp}|{version('mitsuba')}|{version('drjit')}"


def _cache_file() -> Path:
    root = os.environ.get("HARDLIGHT_CACHE") or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(root) / "hardlight" / "backends.json"


def _read_cache() -> dict[str, str | None]:
    try:
        known = json.loads(_cache_file().read_text())
    except (OSError, ValueError):
        return {}
    return known if isinstance(known, dict) else {}


def _write_cache(verdicts: dict[str, str | None]) -> None:
    """Keeps verdicts for the next call; a read-only home costs a second per start and nothing else."""
    path = _cache_file()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        beside = path.with_suffix(f".{os.getpid()}")
        beside.write_text(json.dumps(verdicts, indent=1))
        beside.replace(path)
    except OSError:
        return
