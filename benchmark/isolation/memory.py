"""How much memory a process and its descendants use, read from /proc; nothing is watched where there is none."""

import mmap
import os
import time
from collections.abc import Iterator
from pathlib import Path

_PROC = Path("/proc")
_FAMILY_S = 1.0  # between looks at swapped memory and at descendants, which cost a hundred times a look at the process alone


class MemoryWatch:
    """Watches one process for more than ``limit_bytes``, cheaply enough to be asked many times a second."""

    def __init__(self, pid: int, limit_bytes: float) -> None:
        """Opens what the kernel says of the process."""
        self._pid, self._limit_bytes = pid, limit_bytes
        self._family_at = 0.0
        try:
            self._statm = os.open(_PROC / str(pid) / "statm", os.O_RDONLY | os.O_CLOEXEC)
        except OSError:
            self._statm = -1

    def exceeded(self) -> bool:
        """Whether the process, or it and all that descend from it, hold more, resident or swapped out."""
        if self._statm < 0:
            return False
        now = time.perf_counter()
        if self._resident_bytes() <= self._limit_bytes and now - self._family_at < _FAMILY_S:
            return False
        self._family_at = now
        return _exceeds(self._pid, self._limit_bytes)

    def close(self) -> None:
        """Closes what it opened."""
        if self._statm >= 0:
            os.close(self._statm)
            self._statm = -1

    def _resident_bytes(self) -> int:
        try:
            return int(os.pread(self._statm, 100, 0).split()[1]) * mmap.PAGESIZE
        except (OSError, IndexError):  # it has gone
            return 0


def _exceeds(pid: int, limit_bytes: float) -> bool:
    """Pages that forked processes share count once; that is dear to find out, so it is asked where the plain sum is too much."""
    if sum(_held(one, "status", (b"VmRSS:", b"VmSwap:")) for one in _family(pid)) <= limit_bytes:
        return False
    return sum(_held(one, "smaps_rollup", (b"Pss:", b"SwapPss:")) for one in _family(pid)) > limit_bytes


def _family(pid: int) -> Iterator[int]:
    waiting = [pid]
    while waiting:
        one = waiting.pop()
        yield one
        waiting += _children(one)


def _held(pid: int, file: str, names: tuple[bytes, ...]) -> int:
    """Bytes; 0 where the process has gone."""
    try:
        lines = (_PROC / str(pid) / file).read_bytes().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) * 1024 for line in lines if line.startswith(names))


def _children(pid: int) -> list[int]:
    try:
        tasks = list((_PROC / str(pid) / "task").iterdir())
        return [int(child) for task in tasks for child in (task / "children").read_bytes().split()]
    except OSError:  # it ended meanwhile, or the kernel does not say
        return []
