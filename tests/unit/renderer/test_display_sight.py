"""What a camera's pixels see of a screen: sizes of dots by spectra, shares by brute force, tilted screens and bent lenses."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from renderer.display_places import even_place
from renderer.display_sight import Sight, _ideal
from scenes.arrays import Floats
from scenes.display import Display
from scenes.exr import Window
from scenes.intrinsics import Intrinsics

F_PX = 8.0 / 3.75e-3
DOT_PX = 0.9146
LENS = Intrinsics(256, 64, F_PX, F_PX, 127.5, 31.5)
BENT = (-0.28, 0.09, 1.5e-3, -8e-4, -0.01)


def display(**changes) -> Display:
    """The paper's screen, of fewer dots."""
    own = {"dots": (400, 200), "pitch_m": 0.264e-3, "field_deg": 30.0, "field_dots": 1250, "distance_m": 0.61579}
    return Display.model_validate(own | {"radiance_w_m2_sr": 1.0, "relative_spectrum": 1.0} | changes)


def seen(screen: Display, lens: Intrinsics = LENS, samples: int = 64) -> Sight:
    """What the whole picture of ``lens`` sees."""
    return Sight.of(screen, lens, Window(0, 0, lens.width_px, lens.height_px), samples)


@pytest.mark.parametrize("count", [1, 2, 16, 64, 256])
def test_even_places_fill_each_row_and_column_once_and_are_centred(count: int):
    x, y = even_place(np.arange(count), count)
    for place in (x, y):
        assert np.array_equal(np.sort(place) * count - 0.5, np.arange(count))
    assert [even_place(i, count) for i in range(count)] == list(zip(x.tolist(), y.tolist()))
    half = 2 ** (count.bit_length() // 2)
    boxes = {(int(a * half), int(b * (count // half or 1))) for a, b in zip(x, y)}
    assert len(boxes) == count  # one in each elementary interval


def frequency(row: Floats, near: float) -> float:
    """The frequency, cycles per pixel, of the highest peak within 20 % of ``near``."""
    padded = np.abs(np.fft.rfft((row - row.mean()) * np.hanning(len(row)), 1 << 18))
    at = np.arange(len(padded)) / (1 << 18)
    padded[np.abs(at / near - 1) > 0.2] = 0
    return float(at[np.argmax(padded)])


@pytest.mark.parametrize("axis", [0, 1])
def test_a_dot_is_0_9146_pixels_by_the_spectrum_of_lines(axis: int):
    lines = np.zeros((200, 400), dtype=np.float32)
    lines[(slice(None), slice(None, None, 4)) if axis else (slice(None, None, 4),)] = 1
    lens = LENS if axis else Intrinsics(64, 256, F_PX, F_PX, 31.5, 127.5)
    picture = seen(display(dots=(400, 200) if axis else (200, 400)), lens).mean(lines if axis else lines.reshape(400, 200))
    row = picture[20] if axis else picture[:, 20]
    assert 1 / frequency(row.astype(float), 1 / (4 * DOT_PX)) / 4 == pytest.approx(DOT_PX, rel=2e-4)


def test_the_grid_between_dots_beats_with_the_pixels():
    uniform = np.ones((200, 400), dtype=np.float32)
    row = seen(display(fill_factor=0.6), samples=256).mean(uniform).astype(float).mean(axis=0)
    assert 1 / (1 + frequency(row, 1 / DOT_PX - 1)) == pytest.approx(DOT_PX, rel=1e-3)
    assert row.mean() == pytest.approx(1.0, abs=0.003)  # the meter's mean, whatever the grid takes away
    window = np.hanning(len(row))
    turns = np.exp(-2j * np.pi * (1 / DOT_PX - 1) * np.arange(len(row)))
    depth = 2 * abs((row * window * turns).sum()) / window.sum()
    # Fourier's series of pulses √0.6 dots wide, its first harmonic through the box of a pixel
    assert depth == pytest.approx(abs(2 * np.sinc(1 / DOT_PX) * np.sinc(0.6**0.5)), rel=0.03)


def test_a_full_screen_fills_pixels_and_ends_where_its_last_dot_does():
    sight = seen(display(dots=(100, 40)))
    picture = sight.mean(np.ones((40, 100), dtype=np.float32))
    assert picture[31, 127] == 1.0
    left = 127.5 - 50 * F_PX * 0.264e-3 / 0.61579
    assert picture[31].sum() == pytest.approx(2 * (127.5 - left), abs=0.05)
    rows, columns = np.mgrid[0:64, 0:256]
    beside = (np.abs(columns - 127.5) > 47) | (np.abs(rows - 31.5) > 20)
    assert (picture[beside] == 0).all()
    assert (sight.centre[beside] == -1).all()
    assert sight.centre[31, 127] in (19 * 100 + 49, 19 * 100 + 50)


def test_each_dot_gives_its_area_and_no_more():
    sight = seen(display())
    given = np.asarray(sight.shares.sum(axis=0)).reshape(200, 400)[70:130, 80:320]
    assert given.mean() == pytest.approx(DOT_PX**2, rel=2e-4)
    assert np.abs(given - DOT_PX**2).max() < 0.04  # sampled 64 times a pixel


@pytest.mark.parametrize("screen", [display(fill_factor=0.5), display(tilt_deg=(12.0, -20.0, 7.0), offset_m=(0.003, -0.002))])
def test_shares_are_those_of_a_dense_grid_of_rays(screen: Display):
    sight, side = seen(screen, samples=256), 160
    grid = (np.arange(side) + 0.5) / side - 0.5
    for u, v in [(127, 31), (3, 60), (200, 5)]:
        x, y = np.meshgrid((u + grid - 127.5) / F_PX, (v + grid - 31.5) / F_PX)
        dots = dense(screen, x.ravel(), y.ravel())
        expected = np.bincount(dots[dots >= 0], minlength=400 * 200) / side**2 / screen.fill_factor
        found = sight.shares[[v * 256 + u], :].toarray()[0]
        assert np.abs(found - expected).max() < 0.02
        assert set(np.flatnonzero(expected > 0.02)) <= set(np.flatnonzero(found))


def dense(screen: Display, x: Floats, y: Floats) -> NDArray[np.int64]:
    """Dots met by rays (x, y, 1), by solving x·t·d = c + a·right + b·down for each: another way to the same place."""
    axes = Rotation.from_rotvec(screen.tilt_deg, degrees=True).as_matrix()
    middle = np.array([*screen.offset_m, 0.61579])
    system = np.empty((len(x), 3, 3))
    system[:, :, 0] = np.stack([x, y, np.ones_like(x)], axis=-1)
    system[:, :, 1:] = -axes[:, :2]
    solved = np.linalg.solve(system, np.broadcast_to(middle, (len(x), 3))[..., None])[..., 0]
    place = solved[:, 1:] / 0.264e-3 + (np.array(screen.dots) - 1) / 2
    nearest = np.rint(place).astype(int)
    shines = np.abs(place - nearest).max(axis=1) <= screen.fill_factor**0.5 / 2
    return np.where(shines, nearest[:, 1] * screen.dots[0] + nearest[:, 0], -1)


def test_a_bent_lens_is_followed_within_each_pixel():
    lens = Intrinsics(128, 96, 100.0, 100.0, 62.0, 49.0, BENT)  # 65 degrees wide: pixels so large that the bend shows in one
    pixels = np.array([(0.0, 0.0), (127.0, 95.0), (60.0, 3.0)])
    x, y = _ideal(lens, pixels, 16)
    places = pixels[:, None] + np.stack(even_place(np.arange(16), 16), axis=-1) - 0.5
    again, _ = cv2.projectPoints(
        np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 3), np.zeros(3), np.zeros(3), np.array(lens.matrix), np.array(BENT)
    )
    assert np.abs(again.reshape(places.shape) - places).max() < 1e-6
    straight = lens.normalised_from_pixels(pixels)[:, None] + (places - pixels[:, None]) / 100.0
    assert np.abs(straight - np.stack([x, y], axis=-1)).max() * 100 > 0.05  # without the slope


def test_the_screen_stands_still_so_its_light_is_linear_in_its_dots():
    sight = seen(display())
    rng = np.random.default_rng(1)
    one, other = (rng.random((200, 400), dtype=np.float32) for _ in range(2))
    assert sight.mean(one + 2 * other) == pytest.approx(sight.mean(one) + 2 * sight.mean(other), abs=1e-5)
    found = sight.at_centre(np.arange(80_000, dtype=np.uint32).reshape(200, 400))
    assert np.array_equal(found[sight.centre >= 0], sight.centre[sight.centre >= 0])
