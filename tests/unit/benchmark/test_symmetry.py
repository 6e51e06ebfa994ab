"""Group laws, and that one element serves a whole track."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from benchmark import symmetry

ORDER = {"none": 1, "c2-x": 2, "c2-y": 2, "c2-z": 2, "c4-x": 4, "c4-y": 4, "c4-z": 4, "d2": 4, "octahedral": 24}


def _contains(elements: Rotation, one: Rotation) -> bool:
    return bool(np.any((elements * one.inv()).magnitude() < 1e-9))


@pytest.mark.parametrize("name", symmetry.GROUPS)
def test_each_group_is_closed_has_inverses_and_starts_with_the_identity(name: str) -> None:
    elements = symmetry.group(name)
    assert len(elements) == ORDER[name]
    assert elements[0].magnitude() == 0.0
    for a in elements:
        assert _contains(elements, a.inv())
        assert all(_contains(elements, a * b) for b in elements)


@pytest.mark.parametrize(("name", "axis"), [("c2-x", 0), ("c4-y", 1), ("c4-z", 2)])
def test_a_cyclic_group_keeps_its_axis(name: str, axis: int) -> None:
    fixed = np.eye(3)[axis]
    assert_allclose(symmetry.group(name).apply(fixed), np.tile(fixed, (ORDER[name], 1)), atol=1e-12)


def test_d2_makes_a_box_look_the_same_and_octahedral_permutes_the_axes_of_a_cube() -> None:
    for element in symmetry.group("d2"):
        assert_allclose(np.abs(element.as_matrix()), np.eye(3), atol=1e-12)
    for element in symmetry.group("octahedral"):
        assert_allclose(np.sort(np.abs(element.as_matrix()), axis=0)[-1], 1.0, atol=1e-12)


def test_an_unknown_group_is_refused() -> None:
    with pytest.raises(ValueError, match="no symmetry group is called 'c3-x'"):
        symmetry.group("c3-x")


def test_rectangle_labels_turn_about_the_features_own_normal() -> None:
    target_from_feature = Rotation.from_euler("xyz", [0.3, -0.5, 1.1])
    normal = target_from_feature.apply([1.0, 0.0, 0.0])
    assert_allclose(symmetry.rectangle_labels(target_from_feature).apply(normal), np.tile(normal, (4, 1)), atol=1e-12)


def test_every_element_of_the_group_is_an_exact_answer_for_a_whole_track() -> None:
    truth, elements = Rotation.random(30, rng=0), symmetry.group("octahedral")
    for index, element in enumerate(elements):
        answer = truth * element
        assert symmetry.track_element(truth, answer, elements) == index
        assert symmetry.errors_by_element(truth, answer, elements)[:, index].max() < 1e-7


def test_a_track_that_hops_is_charged_for_its_hops_and_the_few_wrong_frames() -> None:
    truth, elements = Rotation.random(20, rng=2), symmetry.group("c4-x")
    labels = np.zeros(20, dtype=int)
    labels[5:8] = 2
    labels[12] = 1
    hopping = Rotation.concatenate([one * elements[int(k)] for one, k in zip(truth, labels, strict=True)])
    chosen = symmetry.track_element(truth, hopping, elements)
    assert elements[chosen].magnitude() == 0.0
    error = symmetry.errors_by_element(truth, hopping, elements)[:, chosen]
    assert np.count_nonzero(error > 1.0) == 4
    assert symmetry.label_switches(symmetry.frame_labels(truth, hopping, elements)) == 4


def test_one_wild_frame_does_not_choose_the_tracks_element() -> None:
    truth, elements = Rotation.random(9, rng=3), symmetry.group("c2-x")
    answer = Rotation.concatenate([truth[:8] * Rotation.from_rotvec([0.0, 0.02, 0.0]), (truth[8] * elements[1])])
    assert symmetry.track_element(truth, answer, elements) == 0
