"""A LIDAR of a scenario: casts its beams, lets the receiver report, and keeps the truth beside the reports."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from renderer.beams import BeamCaster, Echoes
from renderer.laser_line import LaserLine
from renderer.paper_ranging import paper_reports
from renderer.physical_ranging import physical_reports
from renderer.receiver import Receiver
from renderer.reports import Reports
from renderer.scan_poses import BeamTimes, ScanPoses
from renderer.scan_truth import scan_truth, truth_row
from scenes.laser_beam import sub_ray_directions
from scenes.lidar import Lidar
from scenes.light import Sun
from scenes.lighting import SceneLight
from scenes.ranging_model import PaperRanging, PhysicalRanging
from scenes.recording import Scan
from scenes.scenario import Scenario, Scene
from scenes.sunlight import sunlight_w_m2_nm


@dataclass(frozen=True, slots=True, eq=False)
class Sounding:
    """A scan, its per-beam truth (arrays in the scan's shape), its row of the truth table."""

    scan: Scan
    beams: dict[str, NDArray[Any]]
    truth: dict[str, float]


class Scanner:
    """One LIDAR of a scenario, ready to scan any of its frames."""

    def __init__(self, scenario: Scenario, name: str) -> None:
        """Loads the target at the laser's wavelength and lays out the beams."""
        self._seed, self._name = scenario.seed, name
        self.lidar: Lidar = scenario.lidars[name]
        beams, line = self.lidar.pattern.beams, LaserLine(self.lidar.beam.wavelength_nm)
        self._axes = beams.directions_lidar.reshape(-1, 3)
        self._time_s = beams.time_s.ravel()
        self._rays = sub_ray_directions(self._axes, self.lidar.beam.offsets_rad)
        self._times = BeamTimes.of(self._time_s)
        model, suns = self.lidar.ranging, [light for light in scenario.light_names if isinstance(scenario.lights[light], Sun)]
        self._sun = suns[0] if suns and isinstance(model, PhysicalRanging) and model.filter_width_nm > 0 else None
        self._caster = BeamCaster(scenario.target, line, self._rays, self._times, with_sun=self._sun is not None)
        self._receiver = Receiver.of(self.lidar, model, scenario.target) if isinstance(model, PhysicalRanging) else None

    def take(self, scene: Scene) -> Sounding:
        """The scan of one frame, about ``delay_s`` before the frame's time."""
        poses, sun = self._poses(scene), self._sun_of(scene)
        echoes = self._caster.cast(poses, None if sun is None else sun.direction_target)
        reports = self._reports(echoes, scene.frame, sun)
        beams = scan_truth(reports, echoes, self._rays, poses)
        truth = truth_row(self._lidar_from_target(scene, 0.0), poses.reference, scene, self.lidar, reports.fate)
        shape = (self.lidar.blocks * self.lidar.pattern.shape[0], self.lidar.pattern.shape[1])
        shaped = {key: array.reshape(*shape, *array.shape[2:]) for key, array in beams.items()}
        return Sounding(self._scan(reports, shape), shaped, truth)

    @property
    def is_slow(self) -> bool:
        """Whether rays are traced one by one."""
        return self._caster.is_scalar

    def echoes(self, scene: Scene) -> Echoes:
        """What the sub-rays meet, without a receiver."""
        sun = self._sun_of(scene)
        return self._caster.cast(self._poses(scene), None if sun is None else sun.direction_target)

    def _reports(self, echoes: Echoes, frame: int, sun: SceneLight | None) -> Reports:
        model = self.lidar.ranging
        if isinstance(model, PaperRanging):
            return paper_reports(self.lidar, model, echoes, self._seed, frame, self._name)
        assert self._receiver is not None
        sunlight = 0.0 if sun is None else sunlight_w_m2_nm(sun.irradiance_w_m2_nm, self.lidar.beam.wavelength_nm)
        return physical_reports(self._receiver, echoes, sunlight, self._seed, frame, self._name)

    def _sun_of(self, scene: Scene) -> SceneLight | None:
        """The sun, where the receiver lets any of its light in."""
        return next((light for light in scene.lights if light.name == self._sun), None)

    def _poses(self, scene: Scene) -> ScanPoses:
        return ScanPoses.at(self._times, lambda instant_s: self._lidar_from_target(scene, instant_s - self.lidar.delay_s))

    def _lidar_from_target(self, scene: Scene, after_s: float) -> Any:
        """The pose at an instant counted from the frame's time."""
        chaser_from_target = scene.chaser_from_target if after_s == 0 else scene.pose_at(scene.time_s + after_s)
        return self.lidar.mount.chaser_from_cam.inv() * chaser_from_target

    def _scan(self, reports: Reports, shape: tuple[int, int]) -> Scan:
        points = reports.measured_m[..., None] * self._axes
        time_s = np.broadcast_to(self._time_s - self.lidar.delay_s, reports.measured_m.shape)
        return Scan(
            points_lidar=points.astype(np.float32).reshape(*shape, 3),
            intensity=reports.intensity.astype(np.float32).reshape(shape),
            time_s=time_s.astype(np.float32).reshape(shape),
        )
