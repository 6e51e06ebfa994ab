import math

import numpy as np
import pytest

from renderer.photometry import photometry
from scenes.camera import Camera
from scenes.scenario import load_scenario
from scenes.spectrum import BAND_NM, Spectrum


@pytest.fixture(scope="module")
def paper() -> tuple[Camera, np.ndarray]:
    """The paper's camera and the sun's spectrum."""
    case = load_scenario("zhai2014-in-plane")
    return case.cameras["nav"], case.lights["sun"].spectrum


def test_a_flat_material_keeps_its_number(paper: tuple[Camera, np.ndarray]):
    assert photometry(*paper).effective(0.37) == pytest.approx(0.37, rel=1e-12)


def test_a_materials_number_lies_between_its_ends_and_follows_the_camera(paper: tuple[Camera, np.ndarray]):
    camera, spectrum = paper
    rising = Spectrum(wavelength_nm=(300.0, 1100.0), value=(0.0, 1.0))
    number = photometry(camera, spectrum).effective(rising)
    centroid = (np.trapezoid(photometry(camera, spectrum).weight * BAND_NM, BAND_NM)) / np.trapezoid(
        photometry(camera, spectrum).weight, BAND_NM
    )
    assert number == pytest.approx((centroid - 300) / 800, rel=1e-12)
    assert 550 < centroid < 650  # blue-sensitive silicon in sunlight


def test_the_scale_of_the_light_does_not_matter(paper: tuple[Camera, np.ndarray]):
    camera, spectrum = paper
    one, ten = photometry(camera, spectrum), photometry(camera, 10 * spectrum)
    assert one.electrons_per_radiance == pytest.approx(ten.electrons_per_radiance, rel=1e-12)
    assert one.responsivity_e_j == pytest.approx(ten.responsivity_e_j, rel=1e-12)


def test_the_camera_equation(paper: tuple[Camera, np.ndarray]):
    camera, spectrum = paper
    fold = photometry(camera, spectrum)
    etendue = (3.75e-6) ** 2 * math.pi * 0.9 / (4 * 8.0**2)
    assert fold.electrons_per_radiance == pytest.approx(fold.responsivity_e_j * etendue, rel=1e-12)
    # A monochromatic source: QE / (photon energy).
    line = np.where(BAND_NM == 550.0, 1.0, 0.0)
    photon_j = 6.62607015e-34 * 299792458.0 / 550e-9
    assert photometry(camera, line).responsivity_e_j == pytest.approx(0.64 / photon_j, rel=1e-12)


def test_light_that_the_detector_cannot_see_is_an_error(paper: tuple[Camera, np.ndarray]):
    camera, _ = paper
    infrared = np.where(BAND_NM >= 1080.0, 1.0, 0.0)  # beyond the last wavelength of the camera's table
    with pytest.raises(ValueError, match="do not overlap"):
        photometry(camera, infrared).effective(0.5)
