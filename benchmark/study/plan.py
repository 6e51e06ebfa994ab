"""What a study will cost, from its first point done in full in a place of its own."""

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from benchmark.study.points import points
from benchmark.study.run import run_points
from benchmark.study.spec import Study

_OVERHEAD = 1.05  # scores and page


@dataclass(frozen=True, slots=True)
class StudyPlan:
    """``points`` settings with ``frames`` instants of time in all, seen by ``sensors``; CPU seconds, and bytes of disk."""

    points: int
    frames: int
    sensors: int
    cpu_s: float
    disk_bytes: float
    workers: int

    def sentence(self) -> str:
        """The plan as a person reads it."""
        sensors = f"{self.sensors} sensor{'' if self.sensors == 1 else 's'}"
        return (
            f"{self.points} points, {self.frames} frames × {sensors}: about {_hours(self.cpu_s)} of CPU, "
            f"{_hours(self.cpu_s / self.workers)} with {self.workers} at a time on as many cores, "
            f"and {self.disk_bytes / 1e9:.2g} GB of disk (from one point that was tried)"
        )


def plan(study: Study, workers: int = 1) -> StudyPlan:
    """Renders, answers and bounds one point of ``study`` in a temporary folder, and multiplies.

    The wall time of one process is taken for CPU time; methods start a process of their own for each data set, as they will.
    """
    chosen = points(study)
    unique = list({point.name: point for point in chosen}.values())
    middle = unique[len(unique) // 2]
    with tempfile.TemporaryDirectory(prefix="hardlight-plan-") as folder:
        begun = time.perf_counter()
        index, refused = run_points(study, [middle], Path(folder))
        spent_s = time.perf_counter() - begun
        size = sum(path.stat().st_size for path in Path(folder).rglob("*") if path.is_file())
    runs = max(1, len(index.cases))
    scenario = study.scenario
    if refused:
        spent_s, size = 0.0, 0
    frames = runs * len(unique) * _frames(study)
    return StudyPlan(
        len(unique),
        frames,
        len(scenario.sensors) + len(scenario.lidars),
        _OVERHEAD * spent_s * len(unique),
        float(size * len(unique)),
        workers,
    )


def _frames(study: Study) -> int:
    from scenes.dataset_range import parse_frames

    return len(parse_frames(study.frames, study.scenario.frame_count))


def _hours(seconds: float) -> str:
    hours, minutes = divmod(round(seconds / 60), 60)
    return f"{hours} h {minutes} min" if hours else f"{max(minutes, 1)} min"
