"""Where a picture is searched: around all that is lit, nowhere less."""

import cv2
import numpy as np

from estimators.stereo_ring.lit_window import lit_window


def test_everything_that_is_brighter_than_the_dark_lies_well_inside():
    picture = np.full((480, 640), 4, np.uint8)
    cv2.circle(picture, (300, 200), 60, 120, -1)
    cv2.circle(picture, (420, 260), 12, 12, -1)
    rows, columns = lit_window(picture, 1.5)
    assert rows.start <= 140 - 16
    assert rows.stop >= 272 + 16
    assert columns.start <= 240 - 16
    assert columns.stop >= 432 + 16
    assert (rows.start % 16, columns.start % 16) == (0, 0)
    assert (rows.stop - rows.start) * (columns.stop - columns.start) < 0.3 * picture.size


def test_noise_alone_is_no_light_and_the_whole_picture_is_searched():
    noise = np.random.default_rng(0).poisson(4, (480, 640)).astype(np.uint8)
    assert lit_window(noise, 1.5) == (slice(0, 480), slice(0, 640))


def test_what_reaches_the_border_is_cut_there():
    picture = np.full((100, 130), 4, np.uint8)
    picture[60:, 100:] = 90
    rows, columns = lit_window(picture, 1.5)
    assert (rows.stop, columns.stop) == (100, 130)
