"""What a tumble in orbit costs: 1000 s integrated, then single instants. Run: python tests/speed/orbit.py

CPU time of this process. The scenario song2017, at its own step of 0.1 s.
"""

import time
from collections.abc import Callable
from typing import Any

from scenes.scenario import load_scenario

LIMIT_GRID_S, LIMIT_POSE_MS = 2.0, 0.5
ACCESSES = 1000


def cpu_s(work: Callable[[], Any]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def main() -> None:
    course = load_scenario("song2017").trajectory
    grid_s = cpu_s(lambda: course.chaser_from_target(1000.0, 0, 0))
    print(f"1000 s of truth: {grid_s:.2f} s of CPU (limit {LIMIT_GRID_S})")
    asked = {
        "pose": lambda time_s: course.chaser_from_target(time_s, 0, 0),
        "angular velocity": lambda time_s: course.omega_target_rad_s(time_s, 0),
        "chaser's state": lambda time_s: course.chaser_state(time_s, 0),
        "truth columns": lambda time_s: course.truth_columns(time_s, 0),
    }
    for what, ask in asked.items():
        each_ms = 1e3 / ACCESSES * cpu_s(lambda ask=ask: [ask(index + 0.037) for index in range(ACCESSES)])
        print(f"{what}: {each_ms:.3f} ms of CPU each (limit {LIMIT_POSE_MS})")


if __name__ == "__main__":
    main()
