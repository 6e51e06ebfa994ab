"""A display as a scenario describes it: the paper's geometry, light in both units, levels, what is refused."""

import math

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from scenes.display import Display
from scenes.luminosity import eye_response, lumens_per_watt
from scenes.scenario import Scenario, load_scenario
from scenes.spectrum import BAND_NM, band_irradiance

PLAIN = {
    "dots": (1280, 1024),
    "pitch_m": 0.264e-3,
    "field_deg": 30.0,
    "field_dots": 1250,
    "radiance_w_m2_sr": 1.0,
    "relative_spectrum": 1.0,
}


def display(**changes) -> Display:
    """The paper's geometry with one watt of white."""
    return Display.model_validate(PLAIN | changes)


@pytest.fixture(scope="module")
def paper() -> Scenario:
    """Case 1 on the monitor."""
    return load_scenario("zhai2014-display-in-plane")


def test_the_geometry_is_the_papers(paper: Scenario):
    screen, lens = paper.display, paper.cameras["nav"].intrinsics
    assert screen is not None
    assert screen.true_distance_m * 1e3 == pytest.approx(615.79, abs=0.005)
    assert screen.cam_from_screen.translation[2] == 0.61579
    assert 100.0 * screen.field_dots / screen.focal_dots == pytest.approx(53.59, abs=0.005)  # metres across, 100 m away
    assert lens.fx_px / screen.focal_dots == pytest.approx(0.9146, abs=5e-5)  # pixels to a dot
    assert 100.0 / screen.focal_dots == pytest.approx(0.0429, abs=5e-5)  # metres to a dot, at the target
    assert math.hypot(*screen.dots) * screen.pitch_m / 0.0254 == pytest.approx(17.0, abs=0.05)  # inches


def test_all_dots_for_the_field_would_put_it_at_another_place():
    assert display(field_dots=1280).true_distance_m * 1e3 == pytest.approx(630.57, abs=0.01)
    assert display().true_distance_m == pytest.approx(display(pitch_m=0.132e-3).true_distance_m * 2)


@pytest.mark.parametrize("name", ["zhai2014-display-in-plane", "zhai2014-display-out-of-plane"])
def test_the_scenarios_are_the_papers_sweeps_and_differ_in_one_number(name: str):
    jagged, smooth, bare = (load_scenario(one) for one in (name, f"{name}-antialiased", name.replace("-display", "")))
    assert jagged.display is not None
    assert smooth.display == jagged.display.model_copy(update={"anti_aliasing": 64})
    assert jagged.display.anti_aliasing == 1
    assert (jagged.motion, jagged.target, jagged.frame_count) == (bare.motion, bare.target, bare.frame_count)
    assert jagged.cameras["nav"].model_copy(update={"exposure": bare.cameras["nav"].exposure}) == bare.cameras["nav"]


def test_a_scenario_without_a_display_says_nothing_of_one():
    assert "display" not in load_scenario("zhai2014-in-plane").model_dump(mode="json")
    again = load_scenario("zhai2014-display-in-plane").model_dump(mode="json")
    assert Scenario.model_validate(again) == load_scenario("zhai2014-display-in-plane")


def test_radiance_layers_count_in_the_colour_of_the_screen(paper: Scenario):
    assert paper.display is not None
    assert np.array_equal(paper.radiance_spectrum, paper.display.spectrum)
    bare = load_scenario("zhai2014-in-plane")
    assert np.array_equal(bare.radiance_spectrum, bare.lights["sun"].spectrum)


def test_candela_become_watts(paper: Scenario):
    assert np.trapezoid(eye_response(), BAND_NM) == pytest.approx(106.857, abs=0.001)  # nm, of the standard's table
    assert lumens_per_watt((BAND_NM == 555).astype(float)) == pytest.approx(683, rel=0.006)  # where the eye sees best
    equal_energy = 683 * 106.857 / 800
    assert display(radiance_w_m2_sr=None, luminance_cd_m2=250).white_w_m2_sr == pytest.approx(250 / equal_energy, rel=1e-5)
    assert paper.display is not None
    spectrum = paper.display.spectrum
    assert band_irradiance(spectrum) == pytest.approx(paper.display.white_w_m2_sr, rel=1e-12)
    assert 683 * np.trapezoid(spectrum * eye_response(), BAND_NM) == pytest.approx(250.0, rel=1e-12)


def test_levels_are_whole_and_shine_as_they_should():
    screen = display(contrast=500.0)
    assert np.array_equal(np.unique(screen.levels(np.linspace(0, 1, 1001) ** 2.2)), np.arange(256))
    assert np.array_equal(screen.levels([-0.5, 1.5]), [0, 255])
    assert screen.radiance(255) == 1.0
    assert screen.radiance(0) == pytest.approx(1 / 500)
    share = np.array([0.05, 0.2, 0.5, 0.9])
    shines = (screen.radiance(screen.levels(share)) - 1 / 500) / (1 - 1 / 500)
    assert shines == pytest.approx(share, abs=0.5 * 2.2 / 255)  # half a level, at the steepest
    assert np.abs(shines - share).max() > 1e-4  # they are whole indeed
    fine = display(bits=16)
    assert fine.radiance(fine.levels(share)) == pytest.approx(share * (1 - 1e-3) + 1e-3, abs=3e-5)


def test_what_is_not_drawn_for_the_screens_gamma_comes_out_too_dark():
    raw = display(gamma_encoded=False, bits=16, contrast=1e9)
    assert raw.radiance(raw.levels([0.5, 1.0])) == pytest.approx([0.5**2.2, 1.0], rel=1e-3)


def test_a_screen_in_its_place_subtends_the_angles_that_it_shows():
    screen = display()
    slope = math.tan(math.radians(15))
    column, row = screen.places_from_sight(np.array([0.0, slope, -slope]), np.array([0.0, 0.1, 0.0]))
    assert column == pytest.approx(639.5 + np.array([0, 625, -625]), abs=1e-9)
    assert row == pytest.approx(511.5 + np.array([0, 0.1 * screen.focal_dots, 0]), abs=1e-9)
    near, _ = display(distance_m=screen.true_distance_m / 2).places_from_sight(np.array([slope]), np.array([0.0]))
    assert near - 639.5 == pytest.approx([312.5])
    aside, below = display(offset_m=(0.0264, -0.0132)).places_from_sight(np.zeros(1), np.zeros(1))
    assert (aside[0], below[0]) == pytest.approx((639.5 - 100, 511.5 + 50))


@pytest.mark.parametrize("tilt_deg", [(20.0, 0.0, 0.0), (0.0, -25.0, 0.0), (0.0, 0.0, 40.0), (5.0, 30.0, -10.0)])
def test_a_tilted_screen_is_met_where_its_dots_are(tilt_deg: tuple[float, float, float]):
    screen = display(tilt_deg=tilt_deg, offset_m=(0.02, -0.01), distance_m=0.5)
    dots = np.array([(0, 0), (1279, 0), (640, 511), (100, 1023)], dtype=float)
    flat = np.column_stack([(dots - (639.5, 511.5)) * 0.264e-3, np.zeros(4)])
    points_cam = flat @ Rotation.from_rotvec(tilt_deg, degrees=True).as_matrix().T + (0.02, -0.01, 0.5)
    column, row = screen.places_from_sight(*(points_cam[:, :2] / points_cam[:, 2:]).T)
    assert np.column_stack([column, row]) == pytest.approx(dots, abs=1e-9)


@pytest.mark.parametrize(("tilt_deg", "nearer"), [((10.0, 0.0, 0.0), "top"), ((0.0, 10.0, 0.0), "right")])
def test_tilts_turn_the_way_they_are_said_to(tilt_deg: tuple[float, float, float], nearer: str):
    edge = (0.0, -0.1, 0.0) if nearer == "top" else (0.1, 0.0, 0.0)
    assert display(tilt_deg=tilt_deg).cam_from_screen.apply(edge)[2] < display().true_distance_m


def test_what_looks_past_the_screen_meets_nothing():
    screen = display(tilt_deg=(0.0, 60.0, 0.0))  # its plane stands along the ray that goes right by 60 degrees
    column, _ = screen.places_from_sight(np.array([-3.0, 0.0]), np.zeros(2))
    assert np.isnan(column[0])
    assert column[1] == pytest.approx(639.5)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"luminance_cd_m2": 250.0}, "one of them, not 250.0 and 1.0"),
        ({"radiance_w_m2_sr": None}, "one of them, not None and None"),
        ({"tilt_deg": (0.0, 170.0, 0.0)}, "turns the screen by 170 deg off the camera"),
        ({"anti_aliasing": 3}, "anti_aliasing"),
        ({"fill_factor": 1.2}, "fill_factor"),
        ({"field_deg": 180.0}, "field_deg"),
        ({"contrast": 1.0}, "contrast"),
        (
            {"radiance_w_m2_sr": None, "luminance_cd_m2": 1.0, "relative_spectrum": {"wavelength_nm": [900, 901], "value": [0, 1]}},
            "nobody sees a light of this relative_spectrum",
        ),
    ],
)
def test_a_screen_that_cannot_be_is_refused(changes: dict, says: str):
    with pytest.raises(ValidationError, match=says):
        display(**changes)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ("rig", "one camera films it, and nothing else, but there are nav, pair-left, pair-right"),
        ("camera", "one camera films it, and nothing else, but there are nav, second"),
        ("light", "drawn in one light, but there are sun, second"),
    ],
)
def test_a_display_has_one_camera_and_one_light(paper: Scenario, more: str, says: str):
    tree = paper.model_dump(mode="json")
    nav, sun = tree["cameras"]["nav"], tree["lights"]["sun"]
    changes = {
        "rig": {"rigs": {"pair": {"camera": nav, "baseline_m": 1.0}}},
        "camera": {"cameras": {"nav": nav, "second": nav}},
        "light": {"lights": {"sun": sun, "second": sun}, "key_light": "sun"},
    }
    with pytest.raises(ValidationError, match=says):
        Scenario.model_validate(tree | changes[more])
