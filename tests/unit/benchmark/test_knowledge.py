"""The one door between truth and estimator: what passes through it, how noisy, and that it is recorded."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import RigidTransform

from benchmark.knowledge import _single_camera, declare
from scenes.dataset import Dataset
from scenes.errors import UsageError
from scenes.features import RectangleFeature
from scenes.motion import Spin
from scenes.recording import StereoPair

FACING_DEG = (69.282, 69.282, -69.282)  # the panel's normal, target x, towards the camera


def _true_corners(dataset: Dataset, frame: int = 0) -> np.ndarray:
    feature, truth = dataset.features[0], dataset.truth(frame)
    return dataset.sensors["nav"].intrinsics.project(truth.sensor_from_target["nav"].apply(feature.corners_target))


def test_without_noise_the_clicks_are_the_projected_corners_in_the_papers_order(dataset: Dataset) -> None:
    prior = declare(dataset, "panel", sigma_px=0.0).knowledge.corner_prior
    assert prior is not None
    assert_allclose(prior.corners_px, _true_corners(dataset), atol=1e-12)
    p1, p2, p3, _ = prior.corners_px
    assert p2[0] > p1[0]
    assert p3[1] < p1[1]


def test_clicks_scatter_with_the_declared_sigma(make_dataset: Callable[..., Dataset], tmp_path: Path) -> None:
    offsets = []
    for seed in range(60):
        dataset = make_dataset(tmp_path / str(seed), frames=range(1), seed=seed)
        prior = declare(dataset, "panel", sigma_px=3.0).knowledge.corner_prior
        assert prior is not None
        offsets.append(prior.corners_px - _true_corners(dataset))
    values = np.ravel(offsets)  # 480 draws: standard error of the sd is 3.2 %
    assert values.std() == pytest.approx(3.0, rel=0.11)
    assert values.mean() == pytest.approx(0.0, abs=0.45)


def test_clicks_are_the_same_for_every_method_and_differ_between_features(
    make_dataset: Callable[..., Dataset], tmp_path: Path
) -> None:
    twice = RectangleFeature(name="again", centre_m=(0, 0, 0), length_m=3.0, width_m=1.5)
    features = (make_dataset(tmp_path / "a", frames=range(1)).features[0], twice)
    dataset = make_dataset(tmp_path / "b", frames=range(1), features=features)
    first, again, other = (declare(dataset, name).knowledge.corner_prior for name in ("panel", "panel", "again"))
    assert first is not None
    assert again is not None
    assert other is not None
    assert_allclose(first.corners_px, again.corners_px, atol=0)
    assert np.abs(first.corners_px - other.corners_px).min() > 1e-3


def test_the_record_says_everything_that_was_told(dataset: Dataset) -> None:
    declared = declare(dataset, "panel", grant_aspect=True)
    record, knowledge = declared.record, declared.knowledge
    assert record.corner_prior is not None
    assert knowledge.corner_prior is not None
    assert_allclose(record.corner_prior.corners_px, knowledge.corner_prior.corners_px, atol=0)
    assert knowledge.rectangle is not None
    assert (record.gap, record.free_standing) == (knowledge.rectangle.gap, knowledge.rectangle.free_standing)
    assert record.sentence() == (
        "calibration, how the rectangle 'panel' lies on the target, that open space surrounds it (where it does), "
        "its aspect ratio 2, its 4 corner pixels in the first frame (σ 3 px)"
    )
    assert type(record).model_validate_json(record.model_dump_json()) == record


def test_size_and_position_are_not_told(dataset: Dataset) -> None:
    rectangle = declare(dataset, "panel").knowledge.rectangle
    assert rectangle is not None
    assert rectangle.aspect is None
    assert {"name", "target_from_feature", "gap", "free_standing", "aspect"} == set(rectangle.__dataclass_fields__)


def test_one_feature_needs_no_name_and_a_wrong_name_gets_the_nearest(dataset: Dataset) -> None:
    assert declare(dataset).record.feature == "panel"
    with pytest.raises(UsageError, match=r"no feature is called 'pannel'; did you mean 'panel'\?"):
        declare(dataset, "pannel")


def test_several_features_need_a_choice(make_dataset: Callable[..., Dataset], tmp_path: Path) -> None:
    features = tuple(RectangleFeature(name=n, centre_m=(0, 0, 0), length_m=3.0, width_m=1.5) for n in ("a", "b"))
    dataset = make_dataset(tmp_path / "two", frames=range(1), features=features)
    with pytest.raises(UsageError, match="choose one with --feature: a, b"):
        declare(dataset)


def test_no_feature_means_calibration_alone(make_dataset: Callable[..., Dataset], tmp_path: Path) -> None:
    declared = declare(make_dataset(tmp_path / "none", frames=range(1), features=()))
    assert declared.knowledge.rectangle is None
    assert declared.record.sentence() == "calibration"


def test_a_feature_behind_the_camera_cannot_be_clicked(make_dataset: Callable[..., Dataset], tmp_path: Path) -> None:
    motion = Spin(type="spin", position_m=(0.0, 0.0, -12.0))
    dataset = make_dataset(tmp_path / "behind", frames=range(1), motion=motion)
    with pytest.raises(UsageError, match="not in front of 'nav' in frame 0"):
        declare(dataset, "panel")


def test_a_feature_that_leaves_the_picture_can_be_clicked_only_while_all_of_it_is_there(
    make_dataset: Callable[..., Dataset], tmp_path: Path
) -> None:
    motion = Spin(type="spin", position_m=(0, 0, 12), velocity_m_s=(0.07, 0, 0), rotation_vector_deg=FACING_DEG)
    dataset = make_dataset(tmp_path / "leaving", frames=range(20), motion=motion)
    last = int(((159.5 - 79.5) / 400 * 12 - 1.5) / 0.07)  # x + L/2 = (u - cx) z / f at the picture's right edge
    prior = declare(dataset, "panel", sigma_px=0.0, frame=last).knowledge.corner_prior
    assert prior is not None
    assert prior.corners_px[:, 0].max() <= 159.5
    with pytest.raises(UsageError, match=rf"is not wholly in the picture of 'nav' in frame {last + 1}, .*begin with another"):
        declare(dataset, "panel", frame=last + 1)


def test_a_feature_seen_from_behind_cannot_be_clicked(make_dataset: Callable[..., Dataset], tmp_path: Path) -> None:
    """About the image's vertical, the panel's z: at 89 degrees from the normal it is seen, at 91 no more."""
    motion = Spin(type="spin", position_m=(0, 0, 12), rotation_vector_deg=FACING_DEG, omega_target_deg_s=(0, 0, 1))
    dataset = make_dataset(tmp_path / "turning", frames=range(181), motion=motion)
    assert declare(dataset, "panel", frame=89).knowledge.corner_prior is not None
    for frame in (91, 180):
        with pytest.raises(UsageError, match=f"'panel' faces away from 'nav' in frame {frame}, so its corners cannot be clicked"):
            declare(dataset, "panel", frame=frame)


def test_a_rectangle_is_looked_at_through_a_camera_of_no_rig_wherever_it_is_listed() -> None:
    pair = StereoPair("eyes-left", "eyes-right", RigidTransform.identity())
    sensors = dict.fromkeys(("eyes-left", "eyes-right", "wide"))
    beside, alone = (SimpleNamespace(rigs={"eyes": pair}, sensors=dict(list(sensors.items())[:n])) for n in (3, 2))
    assert _single_camera(beside) == "wide"  # type: ignore[arg-type]
    assert _single_camera(alone) == "eyes-left"  # type: ignore[arg-type]
