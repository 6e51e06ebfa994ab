"""CPU time of one filter step: prediction over a second, update at the scan's instant, prediction of the 50 ms since.

Run: python tests/speed/lidar_filter_step.py. Best of five rounds: others may share the caches.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

sys.path.insert(0, str(Path(__file__).parents[1] / "physics"))

from oracles import tumbling
from oracles.tumble_runs import PAPER, measured

from estimators.lidar_filter.measurement import PoseFilter, PoseMeasurement
from estimators.lidar_filter.paper_filter import PaperFilter
from estimators.lidar_filter.tumble_filter import TumbleFilter

LIMIT_MS = 1.0
DELAY_S = 0.05
STEPS = 400


def cpu_ms(made: Callable[[], PoseFilter], scans: list[PoseMeasurement]) -> float:
    truth, found = tumbling.quiet(STEPS), made()
    found.start(scans[0], truth.chasers[0])
    before = time.process_time()
    for scan, chaser in zip(scans[1:], truth.chasers[1:], strict=True):
        found.update(scan, chaser)
    return (time.process_time() - before) / STEPS * 1e3


def main() -> int:
    truth, R = tumbling.quiet(STEPS), np.diag(np.repeat(PAPER, 3)) ** 2
    scans = [
        PoseMeasurement(chaser.time_s - DELAY_S, RigidTransform.from_components(place[0], turn[0]), R)
        for chaser, (turn, place) in zip(truth.chasers, measured(truth, 1), strict=True)
    ]
    worst = 0.0
    for name, kind in (("lidar-ekf", TumbleFilter), ("lidar-ekf-paper", PaperFilter)):
        rounds = [cpu_ms(lambda kind=kind: kind(tumbling.MOUNT), scans) for _ in range(5)]
        worst = max(worst, min(rounds))
        print(f"{name}: {min(rounds):.3f} ms CPU a step, median {np.median(rounds):.3f} (limit {LIMIT_MS:g})")
    return int(worst > LIMIT_MS)


if __name__ == "__main__":
    sys.exit(main())
