"""Data sets of a docking ring before a stereo rig, drawn by OpenCV at known poses, and a toy method that looks its answer up."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from benchmark.ring_ellipses import PARTS, true_ellipse
from estimators.api import Estimate, Outcome
from scenes.camera import Camera
from scenes.dataset import Dataset
from scenes.dataset_layout import TRUTH_COLUMNS
from scenes.dataset_manifest import Manifest, calibration, rig_entry
from scenes.dataset_writer import DatasetWriter, FrameRecord
from scenes.features import CircleFeature, Feature, MarkerFeature
from scenes.motion import Spin
from scenes.pose_columns import pose_columns
from scenes.recording import Knowledge, Observation
from scenes.rig import StereoRig

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


@dataclass
class LookupRing:
    """A toy method that looks the ring's place up by the frame's number, and honestly uses what it is told of the target.

    ``places``: frame → left_from_ring. ``extras``: frame → named numbers. ``mischief`` makes it misbehave.
    """

    places: dict[int, RigidTransform]
    extras: Callable[[int], dict[str, float]] = field(default=lambda _: {})
    mischief: str = ""
    knowledge: Knowledge | None = None

    def start(self, knowledge: Knowledge) -> None:
        assert knowledge.pair is not None
        self.knowledge = knowledge

    def step(self, observation: Observation) -> Estimate:
        assert self.knowledge is not None
        assert self.knowledge.pair is not None
        assert self.knowledge.ring is not None
        pair, ring_from_target = self.knowledge.pair, self.knowledge.ring.target_from_feature.inv()
        if not all(observation.images[name].pixels.any() for name in (pair.left, pair.right)):
            return Estimate(pair.left, Outcome.NO_FEATURES, reason="black")
        place = self.places.get(observation.frame)
        if place is None:
            return Estimate(pair.left, Outcome.NOT_CONVERGED, reason="no <ellipse> in the right view")
        if self.mischief == "own origin":
            ring_from_target = RigidTransform.from_rotation(ring_from_target.rotation)
        left_from_target = place * ring_from_target
        extras = {**self.extras(observation.frame), "cpu_lookup_s": float(np.random.default_rng().random())}
        return Estimate(pair.left, Outcome.OK, left_from_target.rotation, left_from_target.translation, extras=extras)


@pytest.fixture(scope="session")
def lookup() -> Callable[..., LookupRing]:
    """lookup(dataset, moved=None, extras=..., mischief="", missing=()) → a method that knows the true places.

    ``moved``: by how much it is off, in the ring's own frame.
    """

    def make(
        dataset: Dataset,
        moved: RigidTransform | None = None,
        extras: Callable[[int], dict[str, float]] = lambda _: {},
        mischief: str = "",
        missing: tuple[int, ...] = (),
    ) -> LookupRing:
        (ring,) = (one for one in dataset.features if isinstance(one, CircleFeature))
        ring_from_ring = RigidTransform.identity() if moved is None else moved
        left = next(iter(dataset.rigs.values())).left
        places = {
            frame: dataset.truth(frame).sensor_from_target[left] * ring.target_from_feature * ring_from_ring
            for frame in dataset.frames
            if frame not in missing
        }
        return LookupRing(places, extras, mischief)

    return make


@pytest.fixture(scope="session")
def exact_ellipses() -> Callable[..., Callable[[int], dict[str, float]]]:
    """exact_ellipses(dataset, radius_m=None) → frame → extras with the exact images of the circle, or of a concentric one."""
    def make(dataset: Dataset, radius_m: float | None = None) -> Callable[[int], dict[str, float]]:
        (ring,) = (one for one in dataset.features if isinstance(one, CircleFeature))
        circle = ring if radius_m is None else ring.model_copy(update={"radius_m": radius_m})
        pair = next(iter(dataset.rigs.values()))

        def extras(frame: int) -> dict[str, float]:
            poses, found = dataset.truth(frame).sensor_from_target, {"radius_m": circle.radius_m}
            for view, sensor in (("left", pair.left), ("right", pair.right)):
                ellipse = true_ellipse(circle, poses[sensor], dataset.sensors[sensor].intrinsics)
                assert ellipse is not None
                found |= {f"{view}_{part}": getattr(ellipse, part) for part in PARTS}
            return found

        return extras

    return make
