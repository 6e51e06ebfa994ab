"""LIDARs of the library and of a person: what is refused, what an estimator is told, where a scenario has them."""

import numpy as np
import pytest
from pydantic import ValidationError

from scenes.config import list_library
from scenes.errors import ConfigError
from scenes.lidar import Lidar
from scenes.ranging_model import PaperRanging, PhysicalRanging
from scenes.scenario import load_scenario

FLASH = {"type": "flash", "columns": 8, "rows": 4, "field_deg": (1.0, 1.0)}
BEAM = {"wavelength_nm": 905.0, "divergence_mrad": 1.0}
PAPER = {"type": "paper", "sigma_m": 0.05}
PHYSICAL = {
    "type": "physical",
    "pulse_energy_j": 1e-6,
    "aperture_m": 0.02,
    "transmission": 0.5,
    "quantum_efficiency": 0.5,
    "pulse_width_s": 4e-9,
    "threshold_e": 100.0,
}
WHOLE = {"pattern": FLASH, "beam": BEAM, "ranging": PAPER, "gate_m": (1.0, 50.0)}


@pytest.mark.parametrize("name", list_library("lidars"))
def test_the_library_s_lidars_are_valid_and_say_where_they_come_from(name):
    lidar = load_scenario("song2017", [f"lidars.lidar={name}"]).lidars["lidar"]
    assert lidar.description
    assert lidar.source
    assert 0.005 < lidar.model.range_sigma_m < 0.06
    rows, columns = lidar.pattern.shape
    assert (lidar.model.rows, lidar.model.columns) == (rows * lidar.blocks, columns)


def test_the_presets_are_what_they_are_called():
    lidars = {name: load_scenario("song2017", [f"lidars.lidar={name}"]).lidars["lidar"] for name in list_library("lidars")}
    assert lidars["flash-1572"].pattern.shape == (256, 256)
    assert lidars["rosette-905"].returns == "strongest-and-last"
    assert lidars["rosette-905"].model.range_sigma_m == pytest.approx(0.02, abs=0.005)
    assert lidars["raster-1550"].model.range_sigma_m == pytest.approx(0.01, abs=0.003)
    paper = lidars["song2017-lidar"]
    assert isinstance(paper.ranging, PaperRanging)
    assert (paper.ranging.sigma_m, paper.ranging.cutoff_deg, paper.delay_s) == (0.05, 75.0, 0.05)
    assert paper.mount.position_m == (0.0, 0.0, 2.0)


def test_the_model_is_what_an_estimator_is_told():
    lidar = Lidar.model_validate(WHOLE | {"delay_s": 0.2, "mount": {"position_m": (0.0, 1.0, 2.0)}})
    model = lidar.model
    assert (model.range_sigma_m, model.divergence_rad, model.delay_s, model.duration_s) == (0.05, 1e-3, 0.2, 0.0)
    assert (model.least_range_m, model.most_range_m) == (1.0, 50.0)
    assert model.chaser_from_lidar.translation.tolist() == [0.0, 1.0, 2.0]


def test_range_noise_by_the_formula():
    """c/2 · 4 ns / 2.355 = 0.2546 m; 400 electrons in shot noise alone leave a twentieth of it."""
    model = PhysicalRanging.model_validate(PHYSICAL)
    assert model.pulse_sigma_m == pytest.approx(0.25462, abs=1e-4)
    assert model.range_sigma_m(np.array([400.0]))[0] == pytest.approx(model.pulse_sigma_m / 20)
    assert model.resolution_m == pytest.approx(0.59958, abs=1e-4)


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"gate_m": (50.0, 1.0)}, "not below the most"),
        ({"returns": "strongest-and-last"}, "one return a beam"),
        ({"returns": "second"}, "strongest"),
        ({"pattern": FLASH | {"columns": 4096, "rows": 4096}}, "at most"),
        ({"ranging": PHYSICAL | {"quantum_efficiency": 0.0}}, "greater than 0"),
        ({"ranging": PHYSICAL | {"excess_noise": 0.5}}, "greater than or equal to 1"),
        ({"ranging": PAPER | {"cutoff_deg": 95.0}}, "less than or equal to 90"),
        ({"colour": "red"}, "colour"),
    ],
)
def test_what_no_lidar_can_be_is_refused(changes, fault):
    with pytest.raises(ValidationError, match=fault):
        Lidar.model_validate(WHOLE | changes)


def test_a_misspelt_lidar_is_refused_with_what_there_is():
    with pytest.raises(ConfigError, match=r"lidars\.lidar.*did you mean 'song2017-lidar'"):
        load_scenario("song2017", ["lidars.lidar=song2017-lidr"])


def test_a_library_lidar_is_refined_by_a_few_keys():
    scenario = load_scenario("song2017", ["lidars.lidar.ranging.sigma_m=0.2236", "lidars.lidar.beam.sub_rays=1"])
    assert scenario.lidars["lidar"].model.range_sigma_m == 0.2236
