"""What a stereo method is told: the rig and how the ring lies on the target; neither its size nor its markers."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from benchmark.knowledge import declare
from benchmark.records import KnowledgeRecord
from benchmark.ring_subject import subject_of
from scenes.dataset import Dataset
from scenes.errors import UsageError
from scenes.features import CircleFeature, MarkerFeature, RectangleFeature

PANEL = RectangleFeature(name="panel", centre_m=(0, 0, 0), length_m=0.5, width_m=0.4)


def test_a_ring_comes_with_the_rig_and_without_its_size(stereo: Dataset) -> None:
    declared = declare(stereo, "ring")
    knowledge, rig = declared.knowledge, stereo.rigs["stereo"]
    assert knowledge.ring is not None
    assert knowledge.pair is not None
    assert (knowledge.ring.name, knowledge.ring.radius_m) == ("ring", None)
    assert (knowledge.pair.left, knowledge.pair.right) == ("stereo-left", "stereo-right")
    assert_allclose(knowledge.pair.right_from_left.as_matrix(), rig.right_from_left.as_matrix(), atol=0)
    assert (knowledge.rectangle, knowledge.corner_prior) == (None, None)
    assert set(knowledge.sensors) == {"stereo-left", "stereo-right"}
    assert {"name", "target_from_feature", "radius_m"} == set(knowledge.ring.__dataclass_fields__)


def test_the_record_says_what_was_told_of_a_ring(stereo: Dataset) -> None:
    record = declare(stereo, "ring").record
    told = "calibration, how its two cameras stand to each other, how the ring 'ring' lies on the target"
    assert record.sentence() == told
    assert "how the ring lies on the target" in record.facts(named=False)
    assert KnowledgeRecord.model_validate_json(record.model_dump_json()) == record
    granted = declare(stereo, "ring", grant_radius=True)
    assert granted.knowledge.ring is not None
    assert granted.knowledge.ring.radius_m == 0.6
    assert granted.record.sentence() == f"{told}, its radius 0.6 m"


def test_a_record_from_before_there_were_rings_is_still_read() -> None:
    old = KnowledgeRecord.model_validate_json('{"sensors": ["nav"], "feature": "wing", "gap": null, "free_standing": true}')
    assert (old.pair, old.radius_m) == (None, None)
    assert old.facts()[1] == "how the rectangle 'wing' lies on the target"


def test_the_only_ring_needs_no_name_and_a_marker_is_not_told_of(stereo: Dataset) -> None:
    assert declare(stereo).record.feature == "ring"
    with pytest.raises(UsageError, match=r"'marker-1' is a marker; a method is told of a rectangle or a circle \(ring\)"):
        declare(stereo, "marker-1")
    with pytest.raises(UsageError, match=r"no feature is called 'rign'; did you mean 'ring'\?"):
        declare(stereo, "rign")


def test_a_ring_and_a_rectangle_need_a_choice(make_stereo: Callable[..., Dataset], tmp_path: Path) -> None:
    ring = CircleFeature(type="circle", name="ring", normal=(1, 0, 0), x_axis=(0, 1, 0), radius_m=0.6)
    dataset = make_stereo(tmp_path / "both", frames=range(1), features=(PANEL, ring), draws=False)
    with pytest.raises(UsageError, match="choose one with --feature: panel, ring"):
        declare(dataset)
    assert declare(dataset, "ring").knowledge.rectangle is None
    with pytest.raises(UsageError, match="told of with a circle, not with the rectangle 'panel'"):
        declare(dataset, "panel", rig="stereo")


def test_a_ring_without_a_rig_cannot_be_measured(make_dataset: Callable[..., Dataset], tmp_path: Path) -> None:
    ring = CircleFeature(type="circle", name="ring", normal=(1, 0, 0), x_axis=(0, 1, 0), radius_m=0.6)
    dataset = make_dataset(tmp_path / "mono", frames=range(1), features=(ring,))
    with pytest.raises(UsageError, match=r"'ring' is a circle, which two cameras measure, and .* has no stereo rig"):
        declare(dataset, "ring")


def test_several_rigs_need_a_choice(make_stereo: Callable[..., Dataset], tmp_path: Path) -> None:
    dataset = make_stereo(tmp_path / "rigs", frames=range(1), rigs=("far", "near"), draws=False)
    with pytest.raises(UsageError, match="choose one with --rig: far, near"):
        declare(dataset, "ring")
    pair = declare(dataset, "ring", rig="near").knowledge.pair
    assert pair is not None
    assert pair.left == "near-left"
    with pytest.raises(UsageError, match=r"no stereo rig is called 'nera'; did you mean 'near'\?"):
        declare(dataset, "ring", rig="nera")


def test_the_equivalent_labels_are_the_markers_azimuths_and_always_the_identity(stereo: Dataset) -> None:
    subject = subject_of(declare(stereo, "ring").record, stereo)
    assert subject is not None
    in_ring = subject.target_from_ring.inv() * subject.labels * subject.target_from_ring
    assert_allclose(in_ring.as_euler("ZYX", degrees=True), [[0, 0, 0], [75, 0, 0], [-140, 0, 0]], atol=1e-9)


def test_a_marker_on_the_axis_has_no_azimuth_and_two_on_one_ray_are_one(
    make_stereo: Callable[..., Dataset], tmp_path: Path
) -> None:
    ring = CircleFeature(type="circle", name="ring", radius_m=0.6)
    places = [(0.0, 0.0, 0.1), (0.0, 0.3, 0.0), (0.0, 0.4, 0.0), (-0.3, 1e-17, 0.0), (-0.4, -1e-17, 0.0)]
    markers = tuple(
        MarkerFeature(type="marker", name=f"m{index}", centre_m=centre_m, shape="disc", size_m=0.1)
        for index, centre_m in enumerate(places)
    )
    dataset = make_stereo(tmp_path / "rays", frames=range(1), features=(ring, *markers), draws=False)
    subject = subject_of(declare(dataset, "ring").record, dataset)
    assert subject is not None
    assert_allclose(np.degrees(subject.labels.magnitude()), [0.0, 90.0, 180.0], atol=1e-9)
