"""What a scan costs, in CPU seconds of the whole process. Run: python tests/speed/lidar.py

Two figures: rays against Open3D's RaycastingScene in the same run (ratios carry over to other machines), and whole scans with all
host work: poses, sub-rays, pulses, noise, truth; with and without the files. The first calls compile and are not counted.
"""

import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.beams import BeamCaster
from renderer.laser_line import LaserLine
from renderer.ranging import Scanner
from renderer.scan_poses import BeamTimes, ScanPoses
from scenes.arrays import Floats
from scenes.beam_truth import encode_beams
from scenes.pcd import encode_scan
from scenes.scan_pattern import Flash
from scenes.scenario import Scenario, load_scenario, realize
from scenes.solids import solids

LEAST_MRAYS = 20.0  # million rays per CPU second, of 10⁶ coherent ones with normals and intensity
LEAST_RATIO = 2.0  # against Open3D
MOST_SCAN_S = 0.060  # 128 × 128 beams of 7 sub-rays
REPEATS, POSES = 15, 5


def cpu_s(work: Callable[[int], Any], repeats: int = REPEATS, warm: int = 3) -> float:
    """Median CPU seconds of ``work(i)``."""
    for i in range(warm):
        work(i)
    spent = []
    for i in range(warm, warm + repeats):
        start = time.process_time()
        work(i)
        spent.append(time.process_time() - start)
    return float(np.median(spent))


def mitsuba_rays(scenario: Scenario, rays: Floats, distance_m: float) -> tuple[float, float]:
    """CPU seconds of casting ``rays`` (n, 1, 3) and the share that hits; each time from a pose of its own."""
    times = BeamTimes.of(np.zeros(len(rays)))
    caster = BeamCaster(scenario.target, LaserLine(1064.0), rays, times, with_sun=False)
    scenes = [realize(scenario, scenario.seed, 10 * i) for i in range(POSES)]
    poses = [ScanPoses.at(times, lambda _s, scene=scene: moved(scene.chaser_from_target, distance_m)) for scene in scenes]  # type: ignore[misc]
    return cpu_s(lambda i: caster.cast(poses[i % POSES])), float(np.mean(caster.cast(poses[0]).range_m > 0))


def moved(lidar_from_target: Any, distance_m: float) -> Any:
    """The same attitude on the axis at a distance."""
    return type(lidar_from_target).from_components([0.0, 0.0, distance_m], lidar_from_target.rotation)


def open3d_rays(scenario: Scenario, rays: Floats, distance_m: float) -> float:
    """CPU seconds of Open3D for the same rays from the same poses: ranges, normals and ids come with every cast."""
    import open3d as o3d

    scene = o3d.t.geometry.RaycastingScene()
    for solid in solids(scenario.target):
        vertices = o3d.core.Tensor(solid.vertices_target.astype(np.float32))
        scene.add_triangles(vertices, o3d.core.Tensor(solid.faces.astype(np.uint32)))
    bundles = []
    for i in range(POSES):
        pose = moved(realize(scenario, scenario.seed, 10 * i).chaser_from_target, distance_m).inv()
        turned = pose.rotation.apply(np.array(rays.reshape(-1, 3)))
        bundles.append(np.concatenate([np.broadcast_to(pose.translation, turned.shape), turned], axis=1).astype(np.float32))
    return cpu_s(lambda i: scene.cast_rays(o3d.core.Tensor(bundles[i % POSES]))["t_hit"].numpy())


def scans(lidar: str, files: bool) -> float:
    """CPU seconds of one scan of song2017's target by a LIDAR of 128 × 128 beams, 7 sub-rays each."""
    grid = '{ type = "flash", columns = 128, rows = 128, field_deg = [10.0, 10.0] }'
    scenario = load_scenario("song2017", [f"lidars.lidar={lidar}", f"lidars.lidar.pattern={grid}"])
    scanner = Scanner(scenario, "lidar")

    def work(i: int) -> None:
        sounding = scanner.take(realize(scenario, scenario.seed, 10 * i))
        if files:
            encode_scan(sounding.scan)
            encode_beams(sounding.beams)

    return cpu_s(work)


def main() -> None:
    """Prints each figure beside its limit."""
    print(f"on {os.cpu_count()} cores; CPU seconds of all threads together")
    scenario = load_scenario("song2017")
    rays = Flash(type="flash", columns=1000, rows=1000, field_deg=(10.0, 10.0)).beams.directions_lidar.reshape(-1, 1, 3)
    for distance_m in (64.0, 30.0, 15.0):
        ours, hits = mitsuba_rays(scenario, rays, distance_m)
        theirs = open3d_rays(scenario, rays, distance_m)
        print(
            f"10^6 rays, {hits:.0%} hit: {1 / ours:.1f} million a CPU second (limit {LEAST_MRAYS}), "
            f"Open3D {1 / theirs:.1f}, ratio {theirs / ours:.2f} (limit {LEAST_RATIO})"
        )
    for lidar in ("song2017-lidar", "flash-1572"):
        alone, whole = scans(lidar, files=False), scans(lidar, files=True)
        print(f"{lidar}, 128 x 128 x 7: {alone * 1e3:.1f} ms a scan (limit {MOST_SCAN_S * 1e3:.0f}), {whole * 1e3:.1f} with files")


if __name__ == "__main__":
    main()
