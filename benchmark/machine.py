"""On which machine a method ran: the processor's name, its cores, the system."""

import os
import platform
from pathlib import Path

from benchmark.records import MachineRecord


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
