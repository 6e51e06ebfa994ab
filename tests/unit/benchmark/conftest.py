"""A small data set of a white rectangle that turns, drawn by OpenCV at known poses, and a toy method that finds it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.api import Estimate, Outcome
from scenes.camera import Camera
from scenes.dataset import Dataset
from scenes.dataset_layout import TRUTH_COLUMNS
from scenes.dataset_manifest import Manifest, calibration, rig_entry
from scenes.dataset_writer import DatasetWriter, FrameRecord
from scenes.features import CircleFeature, Feature, MarkerFeature, RectangleFeature
from scenes.intrinsics import Intrinsics
from scenes.motion import AxisSweep, Spin
from scenes.pose_columns import pose_columns
from scenes.recording import Knowledge, Observation, SensorModel
from scenes.rig import StereoRig

SIZE = (160, 120)
SENSOR = SensorModel(Intrinsics(*SIZE, 400.0, 400.0, 79.5, 59.5), black_dn=0.0, white_dn=255.0)
PANEL = RectangleFeature(name="panel", centre_m=(0.0, 0.0, 0.0), length_m=3.0, width_m=1.5, free_standing=True)
OTHER = RectangleFeature(name="plate", centre_m=(0.0, 0.0, 0.0), length_m=1.0, width_m=1.0)


def draw(cam_from_target: RigidTransform, corners_target: np.ndarray = PANEL.corners_target) -> np.ndarray:
    """The panel as a white quadrilateral on dark grey, edges anti-aliased."""
    pixels = np.full(SIZE[::-1], 8, dtype=np.uint8)
    cyclic = SENSOR.intrinsics.project(cam_from_target.apply(corners_target))[[0, 1, 3, 2]]
    if np.isfinite(cyclic).all():
        cv2.fillConvexPoly(pixels, np.round(cyclic * 256).astype(np.int32), 200, lineType=cv2.LINE_AA, shift=8)
    return pixels


@pytest.fixture(scope="session")
def sweep() -> AxisSweep:
    return AxisSweep(type="axis-sweep", axis="y", start_deg=-20.0, rate_deg_s=2.0, range_m=12.0)


@pytest.fixture(scope="session")
def make_dataset(sweep: AxisSweep) -> Callable[..., Dataset]:
    """make_dataset(path, frames=range(21), seed=0, features=(PANEL,), motion=..., symmetry=...) → an opened data set."""

    def make(
        path: Path,
        frames: range = range(21),
        seed: int = 0,
        features: tuple[RectangleFeature, ...] = (PANEL,),
        motion: Any = None,
        symmetry: str = "d2",
    ) -> Dataset:
        motion = sweep if motion is None else motion
        target = {"symmetry": symmetry, "features": [one.model_dump() for one in features]}
        manifest = Manifest.of(
            scenario={"description": "a turning panel", "target": target, "motion": motion.model_dump()},
            seed=seed,
            frames=frames,
            sensors={"nav": calibration(SENSOR)},
            backend={"variant": "opencv"},
            quality="draft",
        )
        writer = DatasetWriter.open(path, manifest)
        for frame in frames:
            pose = motion.chaser_from_target(float(frame), frame, seed)
            truth = dict.fromkeys(TRUTH_COLUMNS, float("nan")) | pose_columns(pose) | {"range_m": 12.0, "lit_fraction": 1.0}
            layers = {"nav": {"z_m": np.zeros(SIZE[::-1], dtype=np.float32)}}
            writer.write(FrameRecord(frame, float(frame), {"nav": draw(pose)}, layers, {"nav": truth}))
        writer.finish()
        return Dataset.open(path)

    return make


@pytest.fixture(scope="session")
def dataset(make_dataset: Callable[..., Dataset], tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    return make_dataset(tmp_path_factory.mktemp("data") / "panel")


@dataclass
class ContourPnP:
    """A toy method that knows the panel's size: bright contour → 4 corners → IPPE. ``mischief`` makes it misbehave."""

    mischief: str = ""
    size_m: tuple[float, float] = (3.0, 1.5)
    last: np.ndarray = field(default_factory=lambda: np.zeros((4, 2)))
    knowledge: Knowledge | None = None

    def start(self, knowledge: Knowledge) -> None:
        if self.mischief == "start":
            raise RuntimeError("no licence")
        assert knowledge.corner_prior is not None
        self.knowledge, self.last = knowledge, np.array(knowledge.corner_prior.corners_px)

    def step(self, observation: Observation) -> Estimate:
        if self.mischief == "raise" and observation.frame == 3:
            raise ZeroDivisionError("division by zero")
        if self.mischief == "nothing" and observation.frame == 3:
            return None  # type: ignore[return-value]
        if self.mischief == "mutate":
            observation.images["nav"].pixels[:] = 0
        corners = self._corners(observation.images["nav"].pixels)
        if corners is None:
            return Estimate("nav", Outcome.NO_FEATURES, reason="no bright quadrilateral")
        self.last = corners
        return self._answer(corners)

    def _corners(self, pixels: np.ndarray) -> np.ndarray | None:
        contours, _ = cv2.findContours((pixels > 100).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        if not contours:
            return None
        found = cv2.approxPolyDP(max(contours, key=len), 8.0, True)[:, 0].astype(float)
        if len(found) != 4:
            return None
        return found[np.argmin(np.linalg.norm(self.last[:, None] - found[None], axis=2), axis=1)]

    def _answer(self, corners: np.ndarray) -> Estimate:
        assert self.knowledge is not None
        assert self.knowledge.rectangle is not None
        along, across = self.size_m[0] / 2, self.size_m[1] / 2
        in_feature = np.array([(0, a * along, b * across) for a, b in ((-1, -1), (1, -1), (-1, 1), (1, 1))])
        camera = self.knowledge.sensors["nav"].intrinsics.matrix
        _, rotation, position = cv2.solvePnP(in_feature, corners, camera, None, flags=cv2.SOLVEPNP_ITERATIVE)
        cam_from_feature = Rotation.from_rotvec(rotation.ravel())
        cam_from_target = cam_from_feature * self.knowledge.rectangle.target_from_feature.inv()
        sensor = "left" if self.mischief == "sensor" else "nav"
        return Estimate(sensor, Outcome.OK, cam_from_target, position.ravel(), extras={"corner_px": float(corners[0, 0])})


@pytest.fixture(scope="session")
def toy() -> type[ContourPnP]:
    return ContourPnP


# A ring that is neither in the middle of its target nor along its axes, and three markers, the main one on the ring's X axis.
RING = CircleFeature(type="circle", name="ring", centre_m=(0.1, -0.2, 0.3), normal=(1, 0, 0), x_axis=(0, 1, 0), radius_m=0.6)
MARKER_AZIMUTHS_DEG = (0.0, 75.0, -140.0)
MARKERS = tuple(
    MarkerFeature(
        type="marker",
        name=f"marker-{index}",
        centre_m=tuple(RING.target_from_feature.apply([0.35 * np.cos(angle), 0.35 * np.sin(angle), -0.05]).tolist()),
        normal=(1, 0, 0),
        x_axis=(0, 1, 0),
        shape="disc",
        size_m=0.1,
    )
    for index, angle in enumerate(np.radians(MARKER_AZIMUTHS_DEG))
)
NODDING = Spin(type="spin", position_m=(0.05, 0.0, 4.0), rotation_vector_deg=(0, 82, 0), omega_target_deg_s=(1.5, 0.4, 0.0))


def small_rig(width_px: int = 256) -> StereoRig:
    """Two cameras of 60 degrees, 1.3 m apart, each turned inwards by 18 degrees."""
    detector = {"full_well_e": 13500, "gain_dn_per_e": 0.02, "read_noise_e": 13, "dark_current_e_s": 0, "quantum_efficiency": 0.5}
    lens = {"pixel_pitch_m": 5.5e-6 * 2048 / width_px, "focal_length_m": 0.00975491015, "f_number": 5.6}
    exposure = {"type": "fixed", "time_s": 4e-3}
    camera = {"width_px": width_px, "height_px": width_px, "detector": detector, "exposure": exposure, **lens}
    return StereoRig(baseline_m=1.3, toe_in_deg=18.0, camera=Camera.model_validate(camera))


def draw_ring(camera: Camera, cam_from_target: RigidTransform) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """A grey panel with a bright ring and dark markers, anti-aliased, and masks in which everything but the panel's edge is lit."""
    lens, size = camera.intrinsics, (camera.height_px, camera.width_px)
    pixels, mask = np.full(size, 4, dtype=np.uint8), np.zeros(size, dtype=np.uint32)

    def fill(points_ring: np.ndarray, grey: int) -> None:
        uv = lens.project(cam_from_target.apply(RING.target_from_feature.apply(points_ring)))
        cv2.fillPoly(pixels, [np.round(uv * 256).astype(np.int32)], grey, lineType=cv2.LINE_AA, shift=8)

    angle = np.linspace(0, 2 * np.pi, 360, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    fill(0.8 * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) - [0, 0, 0.1], 110)
    mask[pixels > 50] = 2
    fill(0.60 * circle, 220)
    fill(0.55 * circle, 110)
    for marker in MARKERS:
        centre_m = RING.target_from_feature.inv().apply(marker.centre_m)
        fill(centre_m + marker.size_m / 2 * circle, 15)
    mask[pixels > 115] = 1 | 16
    return pixels, {"mask": mask, "z_m": np.zeros(size, dtype=np.float32)}


@pytest.fixture(scope="session")
def make_stereo() -> Callable[..., Dataset]:
    """make_stereo(path, frames=range(12), motion=..., features=(RING, *MARKERS), width_px=256, rigs=("stereo",)) → a data set."""

    def make(
        path: Path,
        frames: range = range(12),
        motion: Any = NODDING,
        features: tuple[Feature, ...] = (RING, *MARKERS),
        width_px: int = 256,
        rigs: tuple[str, ...] = ("stereo",),
        draws: bool = True,
    ) -> Dataset:
        rig = small_rig(width_px)
        cameras = {sensor: (name, camera) for name in rigs for sensor, camera in rig.sensors(name).items()}
        target = {"features": [one.model_dump() for one in features]}
        manifest = Manifest.of(
            scenario={"description": "a nodding ring", "target": target, "motion": motion.model_dump()},
            seed=0,
            frames=frames,
            sensors={sensor: calibration(one.model, rig=rig_entry(rig, name, sensor)) for sensor, (name, one) in cameras.items()},
            backend={"variant": "opencv"},
            quality="draft",
        )
        writer = DatasetWriter.open(path, manifest)
        for frame in frames:
            chaser_from_target = motion.chaser_from_target(float(frame), frame, 0)
            images, layers, truth = {}, {}, {}
            for sensor, (_, camera) in cameras.items():
                pose = camera.mount.chaser_from_cam.inv() * chaser_from_target
                blank = np.zeros((width_px, width_px), np.uint8), {"mask": np.zeros((width_px, width_px), np.uint32)}
                images[sensor], layers[sensor] = draw_ring(camera, pose) if draws else blank
                range_m = float(np.linalg.norm(pose.translation))
                truth[sensor] = dict.fromkeys(TRUTH_COLUMNS, float("nan")) | pose_columns(pose) | {"range_m": range_m}
            writer.write(FrameRecord(frame, float(frame), images, layers, truth))
        writer.finish()
        return Dataset.open(path)

    return make


@pytest.fixture(scope="session")
def stereo(make_stereo: Callable[..., Dataset], tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    return make_stereo(tmp_path_factory.mktemp("data") / "ring")
