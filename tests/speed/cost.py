"""What a frame costs: CPU seconds by stage, and whether memory stays flat. Run: python tests/speed/cost.py [frames [scenario]]

CPU time, not wall time: the figures are the process's own whatever else runs on the machine. A frame here is all of it:
render, filter, detect, truth, EXR and PNG encoded and published on disk.
"""

import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import psutil

from renderer import runner, session
from renderer.generate import FrameMaker, manifest_of
from renderer.variant import probe
from scenes.dataset_writer import DatasetWriter
from scenes.scenario import load_scenario

LIMIT_CPU_S = {"standard": 2.0, "fast": 0.8}  # of zhai2014-in-plane
STEREO_LIMIT_CPU_S = {"shu2020-exp1": 20.0, "shu2020-exp2": 8.0}  # a pair at standard, at 3.45 and 7.5 m
spent: dict[str, float] = defaultdict(float)


def timed(stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
    def run(*args: Any, **more: Any) -> Any:
        start = time.process_time()
        try:
            return function(*args, **more)
        finally:
            spent[stage] += time.process_time() - start

    return run


def measure(name: str, quality: str, frames: int, folder: Path, limit_cpu_s: float) -> None:
    spent.clear()
    scenario = load_scenario(name, [f"quality={quality}"])
    maker = FrameMaker(scenario)
    writer = DatasetWriter.open(folder / f"{name}-{quality}", manifest_of(scenario, range(frames), probe()))
    for frame in range(2):  # recording and compilation
        writer.write(maker.record(frame))
    spent.clear()
    memory, start = {}, time.process_time()
    for frame in range(2, frames):
        record = maker.record(frame)
        timed("files", writer.write)(record)
        memory[frame] = psutil.Process().memory_info().rss / 2**20
    total = time.process_time() - start
    n = frames - 2
    other = total - sum(spent.values())
    print(f"{name}, {quality}: {total / n:.3f} CPU s a frame (limit {limit_cpu_s})")
    for stage, seconds in sorted(spent.items()):
        print(f"  {stage:10s} {seconds / n:.4f} s  {seconds / total:6.1%}")
    print(f"  {'other':10s} {other / n:.4f} s  {other / total:6.1%}  (limit 15 %)")
    early = min(20, frames - 1)
    later = [memory[frame] / memory[early] - 1 for frame in memory if frame >= early]
    span = f"{min(later):+.1%} to {max(later):+.1%}"
    first, last = f"{memory[early]:.0f} MiB at frame {early}", f"{memory[frames - 1]:.0f} at frame {frames - 1}"
    print(f"  memory {first}, {last}; between them {span} (limit 5 %)")


def main() -> None:
    """Times both presets of the fly-around, or the pairs of one stereo scenario; the stages are the renderer's own seams."""
    runner.Runner.__call__ = timed("kernels", runner.Runner.__call__)  # type: ignore[method-assign]
    session.denoise_indirect = timed("denoiser", session.denoise_indirect)
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    with tempfile.TemporaryDirectory() as folder:
        if len(sys.argv) > 2:
            measure(sys.argv[2], "standard", frames, Path(folder), STEREO_LIMIT_CPU_S.get(sys.argv[2], float("nan")))
            return
        for quality, count in (("standard", frames), ("fast", min(frames, 60))):
            measure("zhai2014-in-plane", quality, count, Path(folder), LIMIT_CPU_S[quality])


if __name__ == "__main__":
    main()
