"""What crosses to a method's process: values that it may have, bit for bit, and nothing else."""

import os
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.isolation.shared import SharedMemory
from benchmark.isolation.wire import pack, unpack
from scenes.arrays import frozen
from scenes.dataset import Dataset
from scenes.recording import ChaserState, Image, Knowledge, ModelCloud, Observation, Ring, Scan, StereoPair


def _observation(seed: int = 0, pixels: int = 64) -> Observation:
    rng = np.random.default_rng(seed)
    left = Image(frozen(rng.integers(0, 4096, (pixels, pixels + 1)), np.uint16))
    images = {"left": left, "right": Image(np.zeros((3, 5), np.uint8))}
    cloud = rng.normal(size=(4, 6, 3)).astype(np.float32)
    cloud[0, 0] = np.nan
    scan = Scan(cloud, cloud[..., 0], np.zeros((4, 6), np.float32))
    chaser = ChaserState(0.1 + 0.2, Rotation.random(rng=seed), *rng.normal(size=(3, 3)))
    return Observation(7, 1 / 3, MappingProxyType(images), MappingProxyType({"lidar": scan}), chaser)


def _same(one: np.ndarray, other: np.ndarray) -> bool:
    return one.dtype == other.dtype and one.tobytes() == other.tobytes()


def test_an_observation_arrives_bit_for_bit() -> None:
    given = _observation()
    came = unpack(pack(given))
    assert (came.frame, came.time_s) == (7, 1 / 3)
    assert list(came.images) == ["left", "right"]
    assert all(_same(given.images[name].pixels, came.images[name].pixels) for name in given.images)
    for part in ("points_lidar", "intensity", "time_s"):
        assert _same(getattr(given.scans["lidar"], part), getattr(came.scans["lidar"], part))
    assert given.chaser is not None
    assert _same(given.chaser.inertial_from_chaser.as_quat(), came.chaser.inertial_from_chaser.as_quat())
    assert _same(given.chaser.velocity_inertial_m_s, came.chaser.velocity_inertial_m_s)


def test_what_was_read_only_stays_so() -> None:
    came = unpack(pack(_observation()))
    with pytest.raises(ValueError, match="read-only"):
        came.images["left"].pixels[0, 0] = 1
    with pytest.raises(TypeError):
        came.images["left"] = None


def test_transforms_are_not_normalised_on_the_way() -> None:
    """A product's rotation is off by rounding; a method that is told it here or there must compute the same."""
    rotations = Rotation.random(200, rng=0)
    for rotation in rotations:
        transform = RigidTransform.from_components([1, 2, 3], rotation) * RigidTransform.from_components([0, 1, 0], rotation)
        told = Knowledge({}, pair=StereoPair("a", "b", transform), ring=Ring("ring", transform, 0.6))
        came = unpack(pack(told))
        assert _same(came.pair.right_from_left.as_matrix(), transform.as_matrix())
        assert _same(came.ring.target_from_feature.as_matrix(), transform.as_matrix())


def test_neither_the_truth_nor_the_data_set_nor_a_path_can_cross(dataset: Dataset) -> None:
    observation = dataset.observation(3)
    for stowaway in (dataset.truth(3), dataset, dataset.path, Path("frames"), dataset.truth_table()):
        with pytest.raises(TypeError, match="does not go to a method"):
            pack(Observation(0, 0.0, {"nav": observation.images["nav"], "more": stowaway}))  # type: ignore[dict-item]


def test_a_function_of_no_value_crosses_by_name_and_a_closure_not_at_all() -> None:
    with pytest.raises(Exception, match=r"<lambda>"):
        pack(Observation(0, 0.0, {"more": lambda: None}))  # type: ignore[dict-item]


def test_shared_memory_grows_and_gives_copies() -> None:
    ours = SharedMemory()
    theirs = SharedMemory(os.dup(ours.fd))
    seen = []
    for size in (4, 500, 30):
        seen.append((unpack(theirs.get(ours.put(pack(_observation(size, size))))), _observation(size, size)))
    for came, given in seen:  # what was seen first did not change with what came later
        assert _same(came.images["left"].pixels, given.images["left"].pixels)
    ours.close()
    theirs.close()


def test_arrays_without_elements_and_models_cross() -> None:
    cloud = ModelCloud(np.zeros((0, 3)), np.zeros((0, 3)))
    ours = SharedMemory()
    theirs = SharedMemory(os.dup(ours.fd))
    came = unpack(theirs.get(ours.put(pack(Knowledge({}, model=cloud)))))
    assert came.model.points_target.shape == (0, 3)
    ours.close()
    theirs.close()
