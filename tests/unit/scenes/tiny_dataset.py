"""A small data set of made-up frames, a pure function of the frame number. As a program it starts writers, to be killed."""

import os
import signal
import sys
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.dataset_frame import FrameRecord
from scenes.dataset_layout import TRUTH_COLUMNS
from scenes.dataset_manifest import Manifest, calibration
from scenes.dataset_writer import DatasetWriter
from scenes.intrinsics import Intrinsics
from scenes.pose_columns import pose_columns
from scenes.recording import SensorModel

WIDTH, HEIGHT = 48, 32
SOFTWARE = {"hardlight": "0.0", "python": "3"}
RECTANGLE = {"type": "rectangle", "name": "face", "centre_m": [1.5, 0, 0], "length_m": 3.0, "width_m": 2.0, "gap": [0.4, 0.6]}
SCENARIO = {"rate_hz": 2.0, "target": {"parts": [], "features": [RECTANGLE]}}


def manifest(**changes) -> Manifest:
    """The manifest of ten frames, every second of 3 to 21."""
    model = SensorModel(Intrinsics(WIDTH, HEIGHT, 100.0, 101.0, 23.5, 15.5, (0.1, 0.0, 0.0, 0.0, 0.0)), 6.0, 4095.0)
    given = {
        "scenario": SCENARIO,
        "seed": 7,
        "frames": range(3, 23, 2),
        "sensors": {"nav": calibration(model, bits=12), "wide": calibration(model, bits=8)},
        "backend": {"variant": "llvm_ad_rgb", "llvm": "19.1"},
        "quality": {"name": "fast", "spp": 16},
        "software": SOFTWARE,
    }
    return Manifest.of(**{**given, **changes})


def pose(frame: int) -> RigidTransform:
    """Where the target is."""
    return RigidTransform.from_components([0.1 * frame, -1 / 3, 100.0 + frame], Rotation.from_rotvec([0.1 * frame, 0.02, 0.7]))


def record(frame: int) -> FrameRecord:
    """A 12-bit and an 8-bit picture, three layers, all truth columns (one NaN) and one more."""
    rng = np.random.default_rng(frame)
    spot = np.zeros((HEIGHT, WIDTH), np.float32)
    spot[8:20, 10:30] = rng.random((12, 20), dtype=np.float32) - 0.5
    layers = {"z_m": spot, "normal.x": -spot, "part_id": (spot > 0).astype(np.uint32) * np.uint32(2**31 + 1)}
    numbers = {name: float(value) for name, value in zip(TRUTH_COLUMNS, rng.normal(size=len(TRUTH_COLUMNS)))}
    truth = {**numbers, "phase_angle_deg": float("nan"), **pose_columns(pose(frame)), "theta_deg": 0.1 * frame}
    images = {"nav": rng.integers(0, 4096, (HEIGHT, WIDTH), np.uint16), "wide": rng.integers(0, 256, (HEIGHT, WIDTH), np.uint8)}
    both = {"nav": truth, "wide": truth}
    return FrameRecord(frame, frame / 2, images, {"nav": layers, "wide": layers}, both, {"exposure_s": {"nav": 1e-4}})


def write(path: Path, *, resume: bool = False, part: int = 0, parts: int = 1, finish: bool = True) -> None:
    """Writes what is missing, or every ``parts``-th frame of it."""
    writer = DatasetWriter.open(path, manifest(), resume=resume)
    for frame in writer.missing():
        if frame // 2 % parts == part:
            writer.write(record(frame))
    if finish:
        writer.finish()


def content(path: Path) -> dict[str, bytes]:
    """Every file below a folder."""
    return {str(file.relative_to(path)): file.read_bytes() for file in sorted(path.rglob("*")) if file.is_file()}


def serve() -> None:
    """For each line ``path part parts``: forks a writer, which costs no imports, and prints its process number."""
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # ended writers disappear by themselves
    for line in sys.stdin:
        path, part, parts = line.split()
        writer = os.fork()
        if writer == 0:
            write(Path(path), resume=True, part=int(part), parts=int(parts), finish=parts == "1")
            os._exit(0)
        print(writer, flush=True)


if __name__ == "__main__":
    serve()
