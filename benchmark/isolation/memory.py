"""How much memory a process and its descendants use, read from /proc; nothing where there is none."""

from collections.abc import Iterator
from pathlib import Path

_PROC = Path("/proc")


def exceeds(pid: int, limit_bytes: float) -> bool:
    """Whether the process and all that descend from it hold more than ``limit_bytes``, resident or swapped out.

    Pages that forked processes share count once. That is dear to find out, so it is asked only where the plain sum is too much.
    """
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
    """Bytes; 0 where the process has gone, or without /proc."""
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
