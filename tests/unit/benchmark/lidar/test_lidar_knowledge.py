"""What LIDAR methods are told: the LIDARs, and where it is granted the surface that can be seen from outside."""

from typing import Any

import numpy as np
import pytest

from benchmark.knowledge import declare
from benchmark.model_cloud import digest, model_cloud
from benchmark.records import KnowledgeRecord
from scenes.dataset import Dataset
from scenes.errors import UsageError
from scenes.target import Target


def test_without_a_model_the_lidar_is_all_that_is_told(lidar_dataset: Dataset) -> None:
    declared = declare(lidar_dataset)
    assert set(declared.knowledge.lidars) == {"lidar"}
    assert (declared.knowledge.model, declared.knowledge.rectangle, dict(declared.knowledge.sensors)) == (None, None, {})
    assert declared.record.sentence() == "calibration"
    assert declared.record.lidars == ("lidar",)


def test_a_granted_model_is_recorded_and_the_same_every_time(lidar_dataset: Dataset) -> None:
    declared, again = declare(lidar_dataset, grant_model=True), declare(lidar_dataset, grant_model=True)
    assert declared.knowledge.model is not None
    assert declared.record.model is not None
    assert declared.record.model.points == len(declared.knowledge.model.points_target) == 6000
    assert declared.record == again.record
    assert declared.record.sentence() == "calibration, the target's surface as 6000 points"
    assert KnowledgeRecord.model_validate_json(declared.record.model_dump_json()) == declared.record


def test_the_model_is_even_and_only_what_can_be_seen(lidar_target: Any) -> None:
    """A body of 2 × 1.6 × 1.2 m with a panel that touches it, and a box within it that nobody sees.

    The panel covers 0.1 m × 1 m of the body's side at y = 0.8 from 0.9 to 0.9 m: it stands 0.1 m off, so nothing is covered.
    """
    cloud = model_cloud(Target.model_validate(lidar_target), points=20000)
    points, normals = cloud.points_target, cloud.normals_target
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-12)
    on_body = np.isclose(np.abs(points) / [1.0, 0.8, 0.6], 1.0, atol=1e-9).any(axis=1) & (points[:, 1] < 0.85)
    on_panel = points[:, 1] > 0.85
    assert (on_body | on_panel).all()  # nothing of the box inside, whose faces lie 0.25 m from the middle
    body_m2, panel_m2 = 2 * (2 * 1.6 + 2 * 1.2 + 1.6 * 1.2), 2 * (0.1 * 4 + 0.1 * 1 + 4 * 1)
    assert on_panel.mean() == pytest.approx(panel_m2 / (body_m2 + panel_m2), abs=0.015)
    inward = np.sum(normals * (points - np.where(on_panel[:, None], [0, 2.9, 0], 0)), axis=1)
    assert (inward > 0).all()


def test_faces_that_lie_upon_each_other_are_not_told(lidar_target: Any) -> None:
    parts = [part | {"centre_m": [0.0, 2.8, 0.0]} if part["name"] == "panel" else part for part in lidar_target["parts"]]
    cloud = model_cloud(Target.model_validate({**lidar_target, "parts": parts}), points=20000)
    touching = np.isclose(cloud.points_target[:, 1], 0.8) & (np.abs(cloud.points_target[:, [0, 2]]) < [0.049, 0.499]).all(axis=1)
    assert not touching.any()
    beside = np.isclose(cloud.points_target[:, 1], 0.8)
    assert beside.sum() > 500


def test_the_digest_follows_the_points(lidar_target: Any) -> None:
    target = Target.model_validate(lidar_target)
    moved = Target.model_validate({**lidar_target, "parts": lidar_target["parts"][:1]})
    assert digest(model_cloud(target, 500)) == digest(model_cloud(target, 500))
    assert digest(model_cloud(target, 500)) != digest(model_cloud(moved, 500))


def test_a_lidar_is_named_where_there_are_several(make_lidar: Any, tmp_path: Any) -> None:
    dataset = make_lidar(tmp_path / "two", frames=range(1), lidars=("left", "right"))
    assert set(declare(dataset).knowledge.lidars) == {"left", "right"}
    assert set(declare(dataset, lidar="right").knowledge.lidars) == {"right"}
    with pytest.raises(UsageError, match=r"no LIDAR is called 'rigth'; did you mean 'right'\?"):
        declare(dataset, lidar="rigth")


def test_features_and_rigs_are_for_cameras(lidar_dataset: Dataset) -> None:
    with pytest.raises(UsageError, match="feature 'wing' is told of to methods for cameras, not for a LIDAR"):
        declare(lidar_dataset, "wing")
    with pytest.raises(UsageError, match="stereo rig"):
        declare(lidar_dataset, rig="stereo")


def test_a_model_is_for_lidars(dataset: Dataset) -> None:
    with pytest.raises(UsageError, match="a model of the target is told to methods for a LIDAR"):
        declare(dataset, "panel", grant_model=True)
