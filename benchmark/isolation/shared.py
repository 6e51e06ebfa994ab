"""Memory that two processes share, without a name: pictures and scans are copied in by the one and out by the other."""

import mmap
import os
import tempfile
from collections.abc import Sequence

import numpy as np

from benchmark.isolation.wire import Bytes

_ALIGNMENT = 64  # of each part, so that arrays begin where the processor likes them to


class SharedMemory:
    """One message at a time. Give the descriptor ``fd`` to the other process, and the lengths that ``put`` returns."""

    def __init__(self, fd: int | None = None) -> None:
        """New memory, or that of the other process behind ``fd``."""
        self.fd = _unnamed() if fd is None else fd
        self._map: mmap.mmap | None = None

    def put(self, parts: Sequence[Bytes]) -> list[int]:
        """Copies the parts in, over those that were there, and returns their lengths in bytes."""
        lengths = [len(part) for part in parts]
        space = self._space(lengths, grow=True)
        for start, part in zip(_starts(lengths), parts, strict=True):
            space[start : start + len(part)] = part
        return lengths

    def get(self, lengths: Sequence[int]) -> list[Bytes]:
        """Copies of the parts: what a method keeps of a frame must not change with the next."""
        space = self._space(lengths, grow=False)
        copies = [np.empty(length, dtype=np.uint8) for length in lengths]
        for start, copy in zip(_starts(lengths), copies, strict=True):
            copy[:] = space[start : start + len(copy)]
        return copies

    def close(self) -> None:
        """Gives the memory back; the other process keeps its own view of it until it closes that."""
        if self._map is not None:
            self._map.close()
        os.close(self.fd)

    def _space(self, lengths: Sequence[int], grow: bool) -> Bytes:
        needed = max(mmap.PAGESIZE, _starts(lengths)[-1] + lengths[-1])
        if self._map is None or len(self._map) < needed:
            if grow:
                os.ftruncate(self.fd, needed)
            if self._map is not None:
                self._map.close()
            self._map = mmap.mmap(self.fd, needed)
        return np.frombuffer(self._map, dtype=np.uint8)


def _starts(lengths: Sequence[int]) -> list[int]:
    starts = [0]
    for length in lengths[:-1]:
        starts.append(starts[-1] + -(-length // _ALIGNMENT) * _ALIGNMENT)
    return starts


def _unnamed() -> int:
    if hasattr(os, "memfd_create"):
        return os.memfd_create("hardlight-frame")
    with tempfile.TemporaryFile() as file:
        return os.dup(file.fileno())
