"""Memory that two processes share, without a name: the one writes pictures and scans into it, the other's arrays lie in it.

There are several slots of it. A method may keep an array of a frame as long as it likes; the slot in which it lies is not written
again before it has let go. Where it keeps frames in all slots but the last, the following ones go through the last and are copied.
"""

import contextlib
import fcntl
import mmap
import os
import tempfile
import weakref
from collections.abc import Sequence

import numpy as np

from benchmark.isolation.wire import Bytes

SLOTS = 4
_ALIGNMENT = 64  # of each part, so that arrays begin where the processor likes them to


class Slot:
    """Memory for one message. Give the descriptor ``fd`` to the other process, and the lengths that ``put`` returns."""

    def __init__(self, fd: int | None = None) -> None:
        """New memory, or that of the other process behind ``fd``."""
        self.fd = _unnamed() if fd is None else fd
        self._space = np.empty(0, dtype=np.uint8)
        self._given: list[weakref.ref[Bytes]] = []

    def put(self, parts: Sequence[Bytes]) -> list[int]:
        """Copies the parts in, over those that were there, and returns their lengths in bytes."""
        lengths = [len(part) for part in parts]
        needed = _end(lengths)
        if len(self._space) < needed:
            os.ftruncate(self.fd, needed)
        for start, part in zip(_starts(lengths), parts, strict=True):
            self._mapped(needed)[start : start + len(part)] = part
        return lengths

    def get(self, lengths: Sequence[int]) -> list[Bytes]:
        """The parts where they lie. The slot is ``held`` as long as anything of them is used."""
        space = self._mapped(_end(lengths))
        parts = [space[start : start + length] for start, length in zip(_starts(lengths), lengths, strict=True)]
        self._given = [weakref.ref(part) for part in parts]
        return parts

    @property
    def held(self) -> bool:
        """Whether somebody still has an array that lies here."""
        return any(one() is not None for one in self._given)

    def close(self) -> None:
        """Gives the memory back, once nobody's array lies in it any more."""
        self._space = np.empty(0, dtype=np.uint8)
        os.close(self.fd)

    def _mapped(self, needed: int) -> Bytes:
        if len(self._space) < needed:
            self._space = np.frombuffer(mmap.mmap(self.fd, needed), dtype=np.uint8)
        return self._space


def _starts(lengths: Sequence[int]) -> list[int]:
    starts = [0]
    for length in lengths:
        starts.append(starts[-1] + -(-length // _ALIGNMENT) * _ALIGNMENT)
    return starts[:-1]


def _end(lengths: Sequence[int]) -> int:
    return max(mmap.PAGESIZE, _starts([*lengths, 0])[-1])


def _unnamed() -> int:
    """A file without a name; where the system can, one that nobody can cut short while it is mapped."""
    if not hasattr(os, "memfd_create"):
        with tempfile.TemporaryFile() as file:
            return os.dup(file.fileno())
    fd = os.memfd_create("hardlight-frame", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    with contextlib.suppress(OSError):
        fcntl.fcntl(fd, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK)
    return fd
