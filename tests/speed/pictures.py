"""What the pictures' methods cost, in CPU milliseconds. Run: python tests/speed/pictures.py

A frame of ``mono-rectangle`` and a view of the ring's ellipse detector on drawn pictures, one thread. The quickest fifth counts:
CPU seconds grow when other threads share the core. Beside them what a Gaussian blur of one megapixel takes in the same run: the
ratio carries over to other machines, the limits are of ours.
"""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "unit" / "estimators"))

import toy_ring
from toy_sweep import Sweep

from estimators.mono_rectangle.tracked import TrackedRectangle
from estimators.stereo_ring.detector import detect_ellipses
from estimators.stereo_ring.detector_parameters import DetectorParameters

LIMIT_FRAME_MS, LIMIT_VIEW_MS = 30.0, 120.0
PLACES = [(3.45, (0.0, 0.0, 1.0)), (5.2, (-0.8, 0.2, 0.6)), (10.0, (0.0, 0.0, 1.0)), (10.0, (-0.8, 0.2, 0.6))]  # m, light


def cpu_ms(act: Callable[[], Any]) -> float:
    begun = time.process_time()
    act()
    return (time.process_time() - begun) * 1e3


def frames_ms() -> list[float]:
    sweep = Sweep.drawn(case=1, first_deg=-41.931, last_deg=41.931, frames=41)
    method = TrackedRectangle()
    method.start(sweep.knowledge("span"))
    return [cpu_ms(lambda each=each: method.step(each)) for each in sweep.observations]


def views_ms() -> list[float]:
    scenes = [toy_ring.Scene(toy_ring.left_from_ring(z, 12, 7, 10), light=light, texture_dn=4) for z, light in PLACES]
    pictures = [toy_ring.expose(toy_ring.draw(scene, 0), 1) for scene in scenes]
    ways = [DetectorParameters(polarity="same"), DetectorParameters(polarity="any")]
    return [cpu_ms(lambda p=p, way=way: detect_ellipses(p, way)) for _ in range(3) for p in pictures for way in ways]


def blurs_ms() -> list[float]:
    picture = np.random.default_rng(0).random((1000, 1000), dtype=np.float32)
    return [cpu_ms(lambda: cv2.GaussianBlur(picture, (0, 0), 3.0)) for _ in range(40)]


def main() -> int:
    cv2.setNumThreads(1)
    blur = float(np.percentile(blurs_ms(), 20))
    print(f"a Gaussian blur, sigma 3, of 1000 x 1000: {blur:.1f} ms CPU")
    late = 0
    for name, spent, limit in (
        ("mono-rectangle, a frame", frames_ms(), LIMIT_FRAME_MS),
        ("a view's ellipses", views_ms(), LIMIT_VIEW_MS),
    ):
        least, median = np.percentile(spent, [20, 50])
        late += bool(least > limit)
        print(f"{name}: {least:.1f} ms CPU ({least / blur:.1f} blurs), median {median:.1f} (limit {limit:g})")
    return late


if __name__ == "__main__":
    sys.exit(main())
