"""What a method costs: CPU and wall seconds. Imported where methods run, so it imports nothing but the language's own."""

import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass


@dataclass(slots=True)
class Stopwatch:
    """CPU seconds of this process, and wall seconds, of one measured block."""

    cpu_s: float = 0.0
    wall_s: float = 0.0

    @contextmanager
    def running(self) -> Iterator[None]:
        """Measures the block, also when it raises."""
        cpu, wall = spent_cpu_s(), time.perf_counter()
        try:
            yield
        finally:
            self.cpu_s, self.wall_s = spent_cpu_s() - cpu, time.perf_counter() - wall


def spent_cpu_s() -> float:
    """CPU seconds, user and system, of this process with all its threads, and of those of its children that have ended."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + ended.ru_utime + ended.ru_stime
