"""Connected regions: labels against a literal two-pass run, the fill ratio as mended and as printed."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from estimators.stereo_ring.regions import RegionLimits, fill_and_aspect, marker_centres


def two_pass(mask):
    """Section 2.3.2 word for word: labels from the left and upper neighbours with their equalities, then united."""
    labels, parent = np.zeros(mask.shape, int), [0]

    def root(label):
        while parent[label] != label:
            label = parent[label]
        return label

    for v, u in zip(*np.nonzero(mask), strict=True):
        near = [labels[v, u - 1] if u else 0, labels[v - 1, u] if v else 0]
        near = [label for label in near if label]
        if not near:
            parent.append(len(parent))
            labels[v, u] = len(parent) - 1
            continue
        labels[v, u] = min(near)
        low, high = sorted((root(min(near)), root(max(near))))
        parent[high] = low
    return np.array([root(label) for label in range(len(parent))])[labels]


def test_the_labels_of_two_passes_are_opencvs_up_to_their_names():
    rng = np.random.default_rng(7)
    for _ in range(100):
        mask = (rng.random((24, 30)) < rng.uniform(0.2, 0.8)).astype(np.uint8)
        ours, theirs = two_pass(mask), cv2.connectedComponents(mask, connectivity=4)[1]
        pairs = np.unique(np.stack([ours.ravel(), theirs.ravel()]), axis=1)
        assert len(np.unique(pairs[0])) == len(np.unique(pairs[1])) == pairs.shape[1]


def test_diagonal_neighbours_are_two_regions():
    """The negative control: with eight neighbours they are one."""
    mask = np.eye(4, dtype=np.uint8)
    assert len(np.unique(two_pass(mask))) == 5
    assert cv2.connectedComponents(mask, connectivity=4)[0] == 5
    assert cv2.connectedComponents(mask, connectivity=8)[0] == 2


def shape(kind, side, canvas=120):
    v, u = np.indices((canvas, canvas)) - (canvas - 1) / 2
    inside = {
        "square": np.maximum(np.abs(u), np.abs(v)) < side / 2,
        "turned": np.abs(u) + np.abs(v) < side / np.sqrt(2),
        "disc": np.hypot(u, v) < side / 2,
    }[kind]
    return np.where(inside, 20, 200).astype(np.uint8)


def fill(picture, extra):
    area = float((picture < 60).sum())
    columns, rows = np.ptp(np.nonzero((picture < 60).any(axis=0))) + 1.0, np.ptp(np.nonzero((picture < 60).any(axis=1))) + 1.0
    return fill_and_aspect(area, columns, rows, extra)[0]


@pytest.mark.parametrize("side", [15, 20, 28, 36, 45, 54])
def test_the_fill_ratio_of_regular_shapes(side):
    assert fill(shape("square", side, 120 + side % 2), 1) == 1.0
    assert 0.49 <= fill(shape("turned", side), 1) <= 0.55
    assert 0.74 <= fill(shape("disc", side, 120 + side % 2), 1) <= 0.79


@pytest.mark.parametrize(("side", "printed"), [(15, 1.148), (20, 1.108), (54, 1.038)])
def test_as_printed_a_square_is_more_than_full_and_refused(side, printed):
    picture = shape("square", side, 120 + side % 2)
    assert fill(picture, 0) == pytest.approx(printed, abs=1e-3)
    limits = RegionLimits(area_px=(100, 3000))
    assert len(marker_centres(picture, limits)) == 1
    assert len(marker_centres(picture, replace(limits, box_extra_px=0))) == 0


def test_a_marker_is_found_at_its_centroid_and_each_limit_refuses():
    picture = np.full((200, 300), 150, np.uint8)
    picture[50:80, 100:131] = 30
    assert marker_centres(picture, RegionLimits()) == pytest.approx(np.array([[115.0, 64.5]]))
    picture[:] = 150
    picture[10:14, 10:290] = 30  # long
    picture[50:150, 50:150] = 30  # large
    picture[20:25, 280:285] = 30  # small
    picture[160:190, 200:230] = 0  # true black
    picture[100:130, 200:230] = 61  # too bright
    assert marker_centres(picture, RegionLimits()).shape == (0, 2)
    assert marker_centres(np.full((20, 20), 255, np.uint8), RegionLimits()).shape == (0, 2)
    assert marker_centres(np.full((60, 50), 30, np.uint8), RegionLimits()) == pytest.approx(np.array([[24.5, 29.5]]))
