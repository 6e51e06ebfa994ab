"""The pinhole camera with Brown-Conrady distortion, held against OpenCV."""

import cv2
import numpy as np
import pytest

from scenes.intrinsics import Intrinsics

LENSES = {
    "pinhole": Intrinsics(1292, 964, 2133.3, 2133.3, 645.5, 481.5),
    "two focal lengths": Intrinsics(640, 480, 500.0, 520.0, 300.0, 250.0),
    "barrel": Intrinsics(1024, 768, 887.0, 887.0, 511.5, 383.5, (-0.3, 0.1, 0.0, 0.0, 0.0)),
    "all terms": Intrinsics(800, 600, 640.0, 650.0, 371.0, 322.0, (-0.25, 0.08, 2e-3, -1e-3, -0.01)),
    "pincushion": Intrinsics(640, 480, 500.0, 500.0, 319.5, 239.5, (0.2, 0.05, 0.0, 1e-3, 0.0)),
}


def _pixels(lens: Intrinsics) -> np.ndarray:
    rows, columns = np.mgrid[-0.5 : lens.height_px - 0.5 : 23j, -0.5 : lens.width_px - 0.5 : 29j]
    return np.stack([columns, rows], axis=-1).reshape(-1, 2)


@pytest.mark.parametrize("name", LENSES)
def test_projection_is_opencvs(name: str):
    lens = LENSES[name]
    sight = lens.normalised_from_pixels(_pixels(lens))
    depth = np.random.default_rng(0).uniform(1, 200, len(sight))
    points = np.column_stack([sight * depth[:, None], depth])
    expected, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), np.array(lens.matrix), np.array(lens.distortion))
    assert np.abs(lens.project(points) - expected[:, 0]).max() < 1e-9


@pytest.mark.parametrize("name", LENSES)
def test_every_pixel_of_the_picture_comes_back(name: str):
    lens = LENSES[name]
    pixels = _pixels(lens)
    assert np.abs(lens.pixels_from_normalised(lens.normalised_from_pixels(pixels)) - pixels).max() < 1e-9
    rays = lens.rays(pixels)
    assert np.abs(np.linalg.norm(rays, axis=-1) - 1).max() < 1e-15
    assert np.abs(lens.project(17.0 * rays) - pixels).max() < 1e-9


def test_the_inverse_is_opencvs_too():
    lens = LENSES["all terms"]
    pixels = _pixels(lens)
    steps = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 500, 1e-14)
    expected = cv2.undistortPoints(pixels[:, None], np.array(lens.matrix), np.array(lens.distortion), criteria=steps)
    assert np.abs(lens.normalised_from_pixels(pixels) - expected[:, 0]).max() < 1e-9


def test_shapes_are_kept():
    lens = LENSES["all terms"]
    assert lens.project(np.ones((2, 3, 4, 3))).shape == (2, 3, 4, 2)
    assert lens.rays(np.ones((5, 2))).shape == (5, 3)
    assert lens.project([0.0, 0.0, 1.0]).shape == (2,)
    assert lens.project([0.0, 0.0, 1.0]).tolist() == [371.0, 322.0]


def test_what_is_not_in_front_has_no_pixel():
    lens = LENSES["pinhole"]
    pixels = lens.project([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert np.isnan(pixels[:2]).all()
    assert np.isfinite(pixels[2]).all()


@pytest.mark.parametrize(
    ("distortion", "radius"),
    [
        pytest.param((-0.3, 0.0, 0.0, 0.0, 0.0), np.sqrt(1 / 0.9), id="k1 alone: 1 + 3 k1 r² = 0"),
        pytest.param((0.1, -0.2, 0.0, 0.0, 0.0), np.sqrt((0.3 + np.sqrt(4.09)) / 2), id="k2 turns it back"),
        pytest.param((0.0, 0.0, 0.0, 0.0, -0.1), (1 / 0.7) ** (1 / 6), id="k3 alone"),
        pytest.param((0.2, 0.0, 0.0, 0.0, 0.0), np.inf, id="pincushion never folds"),
        pytest.param((0.0, 0.0, 0.01, 0.01, 0.0), np.inf, id="tangential terms do not count"),
        pytest.param((0.0,) * 5, np.inf, id="pinhole"),
    ],
)
def test_the_field_ends_where_the_polynomial_folds_back(distortion: tuple[float, ...], radius: float):
    lens = Intrinsics(100, 100, 100.0, 100.0, 49.5, 49.5, distortion)
    assert lens.fold_radius == pytest.approx(radius, rel=1e-9)
    if np.isfinite(radius):
        r = np.linspace(0, 2 * lens.fold_radius, 4001)
        image = lens.pixels_from_normalised(np.column_stack([r, np.zeros_like(r)]))[:, 0]
        seen = np.isfinite(image)
        assert np.array_equal(seen, r < lens.fold_radius)
        assert (np.diff(image[seen]) > 0).all()  # one pixel, one direction


def test_the_matrix_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        LENSES["pinhole"].matrix[0, 0] = 1.0
