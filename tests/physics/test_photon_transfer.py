"""EMVA 1288's measurements (release 4.0) on rendered flat fields: they must give back the data sheet that was typed in."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from oracles.studio import Studio, box, camera, direct, exposure_s, scenario, still

from renderer.detection import detect, fixed_pattern
from renderer.quality import Preset
from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.exr import Window

WIDTH, HEIGHT = 256, 192
CAMERAS = {
    "12 bit": {
        "bits": 12,
        "gain_dn_per_e": 0.4,
        "full_well_e": 9500.0,
        "black_level_dn": 64.0,
        "read_noise_e": 7.0,
        "dark_current_e_s": 30.0,
        "prnu": 0.008,
        "dsnu_e": 3.0,
    },
    "8 bit": {
        "bits": 8,
        "gain_dn_per_e": 0.04,
        "full_well_e": 6300.0,
        "black_level_dn": 6.0,
        "read_noise_e": 10.0,
        "dark_current_e_s": 30.0,
        "prnu": 0.012,
        "dsnu_e": 6.0,
    },
}


@dataclass(frozen=True, slots=True, eq=False)
class FlatField:
    """Many frames at one exposure: mean over all, temporal variance (mean over pixels), spatial variance of the true means."""

    electrons: float
    mean_dn: float
    temporal_dn2: float
    spatial_dn2: float


class Bench:
    """A camera before a white plate that fills its picture."""

    def __init__(self, detector: dict[str, Any]) -> None:
        settings = {f"detector_{name}": value for name, value in detector.items()} | {"detector_shot_noise": True}
        case = scenario([box((60.0, 60.0, 0.1))], camera(WIDTH, HEIGHT, **settings), still(20.0))
        studio = Studio(case, Preset(16, 0, denoise_indirect=False))
        self.camera: Camera = studio.camera
        rendered = direct(studio.session.radiance(studio.view())) * studio.electrons_per_radiance / exposure_s(studio.camera)
        self._rate = rendered.astype(np.float32)
        self._pattern = fixed_pattern(self.camera, "cam", seed=0)
        self._window = Window(0, 0, WIDTH, HEIGHT)

    def flat(self, electrons: float, frames: int) -> FlatField:
        """The plate exposed so that it makes ``electrons`` in the mean pixel."""
        return self._measure(electrons, electrons / float(self._rate.mean()), frames, lit=True)

    def dark(self, time_s: float, frames: int) -> FlatField:
        """The lens cap on."""
        return self._measure(0.0, time_s, frames, lit=False)

    def _measure(self, electrons: float, time_s: float, frames: int, *, lit: bool) -> FlatField:
        rng = np.random.default_rng(round(electrons) + round(1e3 * time_s))
        image = self._rate * np.float32(time_s if lit else 0.0)
        first, second = np.zeros((HEIGHT, WIDTH)), np.zeros((HEIGHT, WIDTH))
        for _ in range(frames):
            picture = detect(image, self._window, self.camera, time_s, self._pattern, rng).astype(np.float64)
            first += picture
            second += picture**2
        mean = first / frames
        temporal = (second - frames * mean**2) / (frames - 1)
        spatial = mean.var(ddof=1) - temporal.mean() / frames
        return FlatField(electrons, float(mean.mean()), float(temporal.mean()), float(spatial))


@pytest.fixture(scope="module", params=list(CAMERAS))
def bench(request: pytest.FixtureRequest) -> tuple[Bench, dict[str, float]]:
    """A bench and the data sheet that it should give back."""
    return Bench(CAMERAS[request.param]), CAMERAS[request.param]


@pytest.fixture(scope="module")
def series(bench: tuple[Bench, dict[str, float]]) -> list[FlatField]:
    """Six exposures from a few per cent of the well to half of it.

    The 8-bit camera's read noise alone is 0.4 DN, too little to dither its converter, so dark frames would tell of the
    rounding instead; at 200 electrons shot noise has done that (e^{−2π²σ²} < 1e-4).
    """
    return [bench[0].flat(electrons, 150) for electrons in (200, 300, 450, 800, 1600, 3000)]


def test_gain_and_read_noise_are_the_photon_transfer_lines(bench: tuple[Bench, dict[str, float]], series: list[FlatField]):
    sheet = bench[1]
    signal = np.array([field.mean_dn - sheet["black_level_dn"] for field in series])
    variance = np.array([field.temporal_dn2 for field in series])
    slope, intercept = _weighted_line(signal, variance, 1 / variance)
    assert slope == pytest.approx(sheet["gain_dn_per_e"], rel=0.02)
    read_dn2 = intercept - 1 / 12  # the converter's own uniform noise
    assert np.sqrt(read_dn2) / slope == pytest.approx(sheet["read_noise_e"], rel=0.02)


def test_the_mean_signal_is_the_gain_times_the_rendered_electrons(bench: tuple[Bench, dict[str, float]], series: list[FlatField]):
    sheet = bench[1]
    for field in series:
        expected = sheet["black_level_dn"] + sheet["gain_dn_per_e"] * field.electrons
        assert field.mean_dn == pytest.approx(expected, rel=0.002, abs=0.02)


def test_fixed_patterns_are_prnu_and_dsnu(bench: tuple[Bench, dict[str, float]], series: list[FlatField]):
    sheet = bench[1]
    electrons = np.array([field.electrons for field in series])
    spatial_e2 = np.array([field.spatial_dn2 for field in series]) / sheet["gain_dn_per_e"] ** 2
    # Spatial variance = DSNU² + PRNU² μ²; the plate itself is flat to 1e-3 of that.
    slope, intercept = _weighted_line(electrons**2, spatial_e2, 1 / spatial_e2)
    assert np.sqrt(slope) == pytest.approx(sheet["prnu"], rel=0.02)
    assert np.sqrt(intercept) == pytest.approx(sheet["dsnu_e"], rel=0.02)


def test_dark_signal_grows_with_the_dark_current(bench: tuple[Bench, dict[str, float]]):
    camera_bench, sheet = bench
    times_s = np.array([4.0, 10.0, 20.0, 40.0])
    dark = [camera_bench.dark(float(time_s), 12).mean_dn for time_s in times_s]
    slope, black = np.polyfit(times_s, dark, 1)
    assert slope / sheet["gain_dn_per_e"] == pytest.approx(sheet["dark_current_e_s"], rel=0.02)
    assert black == pytest.approx(sheet["black_level_dn"], abs=0.05)


def _weighted_line(x: Floats, y: Floats, weight: Floats) -> tuple[float, float]:
    slope, intercept = np.polyfit(x, y, 1, w=weight)
    return float(slope), float(intercept)
