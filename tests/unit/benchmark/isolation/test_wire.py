"""What crosses to a method's process: values that it may have, bit for bit, and nothing else."""

import os
from collections.abc import Iterator
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.isolation.shared import Slot
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


@pytest.fixture
def slot() -> Iterator[tuple[Slot, Slot]]:
    """The judge's end of a slot and the method's."""
    ours = Slot()
    theirs = Slot(os.dup(ours.fd))
    yield ours, theirs
    ours.close()
    theirs.close()


def test_a_slot_grows_and_is_held_as_long_as_anything_of_it_is_used(slot: tuple[Slot, Slot]) -> None:
    ours, theirs = slot
    for size in (4, 500, 30):
        came = unpack(theirs.get(ours.put(pack(_observation(size, size)))))
        assert _same(came.images["left"].pixels, _observation(size, size).images["left"].pixels)
        assert came.images["left"].pixels.ctypes.data % 64 == 0
        assert theirs.held
        kept = came.images["left"].pixels[1:, ::2].T
        del came
        assert theirs.held
        before = kept.copy()
        del kept
        assert not theirs.held
        assert before.any()


def test_an_array_outlives_the_growth_of_its_slot(slot: tuple[Slot, Slot]) -> None:
    """A method that kept it is not asked through that slot again, but its memory must stay its memory."""
    ours, theirs = slot
    kept = unpack(theirs.get(ours.put(pack(_observation(1, 8))))).images["right"].pixels
    theirs.get(ours.put(pack(_observation(2, 900))))
    assert kept.shape == (3, 5)
    kept.tobytes()


def test_arrays_without_elements_and_models_cross(slot: tuple[Slot, Slot]) -> None:
    ours, theirs = slot
    cloud = ModelCloud(np.zeros((0, 3)), np.zeros((0, 3)))
    came = unpack(theirs.get(ours.put(pack(Knowledge({}, model=cloud)))))
    assert came.model.points_target.shape == (0, 3)


@pytest.mark.skipif(not hasattr(os, "memfd_create"), reason="only Linux has seals")
def test_nobody_can_cut_a_slot_short(slot: tuple[Slot, Slot]) -> None:
    """Else whoever touched it would be killed by the system."""
    ours, theirs = slot
    ours.put(pack(_observation()))
    with pytest.raises(PermissionError):
        os.ftruncate(theirs.fd, 0)
