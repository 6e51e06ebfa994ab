"""What a method costs and on which machine: CPU and wall seconds, the processor's name."""

import os
import platform
import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from benchmark.records import MachineRecord


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


def this_machine() -> MachineRecord:
    """Processor, cores, system and Python of this machine."""
    return MachineRecord(
        processor=_processor_name(),
        cores=os.cpu_count(),
        system=f"{platform.system()} {platform.machine()}",
        python=platform.python_version(),
    )


def _processor_name() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()
