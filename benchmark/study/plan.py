"""What a study will cost, from two of its points done in full in a place of their own."""

import resource
import tempfile
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
            f"and {self.disk_bytes / 1e9:.2g} GB of disk (from two points that were tried)"
        )


def plan(study: Study, workers: int = 1) -> StudyPlan:
    """Does two points of ``study`` in a temporary folder: the first pays for the start, the second counts for all others."""
    unique = list({point.name: point for point in points(study)}.values())
    tried = [unique[0], unique[len(unique) // 2]] if len(unique) > 1 else unique
    spent = []
    with tempfile.TemporaryDirectory(prefix="hardlight-plan-") as folder:
        for point in tried:
            before = _cpu_s()
            run_points(study, [point], Path(folder))
            spent.append(_cpu_s() - before)
        size = sum(path.stat().st_size for path in Path(folder).rglob("*") if path.is_file()) / len(tried)
    seeds = study.seeds if isinstance(study.seeds, int) else len(study.seeds)
    return StudyPlan(
        points=len(unique),
        frames=max(1, seeds) * len(unique) * _frames(study),
        sensors=len(study.scenario.sensors) + len(study.scenario.lidars),
        cpu_s=_OVERHEAD * (spent[0] + spent[-1] * (len(unique) - 1)),
        disk_bytes=float(size * len(unique)),
        workers=workers,
    )


def _cpu_s() -> float:
    """Of this process and of those that it started and that have ended."""
    return sum(used.ru_utime + used.ru_stime for used in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))


def _frames(study: Study) -> int:
    from scenes.dataset_range import parse_frames

    return len(parse_frames(study.frames, study.scenario.frame_count))


def _hours(seconds: float) -> str:
    hours, minutes = divmod(round(seconds / 60), 60)
    return f"{hours} h {minutes} min" if hours else f"{max(minutes, 1)} min"
