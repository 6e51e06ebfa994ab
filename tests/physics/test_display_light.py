"""A display's light by hand calculation: shade, level, radiance, electrons, digital numbers; shadows, masks, exposure."""

from typing import Any

import numpy as np
import pytest
from oracles.edges import fit_corners
from oracles.monitor import DOT_PX, SMOOTH, photographs, plate, screen_of, through_lens, true_corners, with_changes
from oracles.studio import LAMBERT, box, inside

from renderer.masks import Light
from renderer.optics import blurred
from renderer.photometry import photometry
from renderer.plan import plan
from scenes.constants import PLANCK_J_S, SPEED_OF_LIGHT_M_S
from scenes.errors import UsageError
from scenes.scenario import Scenario

SUN = np.array([0.35, -0.5, -0.8]) / np.linalg.norm([0.35, -0.5, -0.8])
GUPPY = {
    "pixel_pitch_m": 3.75e-6,
    "focal_length_m": 0.008,
    "f_number": 8.0,
    "transmission": 0.9,
    "detector": {
        "quantum_efficiency": 0.5, "full_well_e": 1e5, "gain_dn_per_e": 0.04, "bits": 8, "black_level_dn": 6.0, "shot_noise": False
    },
}  # fmt: skip


def test_a_white_screen_gives_the_number_of_the_camera_equation():
    (photo,) = photographs(plate(cam=GUPPY, background=1.0), [0])
    # Flat from 450 to 650 nm: a mean photon of 550 nm. E = π L τ / (4 N²) on a pixel, for 20 ms.
    per_joule = 0.5 * 550e-9 / (PLANCK_J_S * SPEED_OF_LIGHT_M_S)
    electrons = 1.0 * np.pi * 0.9 / (4 * 8.0**2) * (3.75e-6) ** 2 * per_joule * 0.020
    by_hand = 6 + 0.04 * electrons
    assert 150 < by_hand < 250
    assert (photo.pixels[:20] == np.floor(by_hand + 0.5)).all()
    assert photo.layers["direct_diffuse"][:20] == pytest.approx(1.0, abs=1e-6)


def test_a_shade_is_drawn_rounded_and_shines_as_by_hand():
    case = plate(contrast=800.0, ambient=0.2)
    (photo,) = photographs(case, [0])
    drawn = 0.5 * (0.2 + 0.8 * -SUN[2])  # the plate is a paint that reflects one half, and faces the camera
    level = np.floor(255 * drawn ** (1 / 2.2) + 0.5)
    shines = 1 / 800 + (1 - 1 / 800) * (level / 255) ** 2.2
    assert photo.layers["direct_diffuse"][40:80, 120:280] == pytest.approx(shines, rel=1e-6)
    assert photo.layers["direct_diffuse"][:20] == pytest.approx(1 / 800, rel=1e-6)
    assert shines == pytest.approx(drawn, rel=0.01)  # the picture is drawn for the screen's gamma


def test_what_is_not_encoded_for_the_screen_shrinks_by_the_integral_of_its_gamma():
    sizes = []
    for encoded in (True, False):
        case = plate("x", 10.0, gamma_encoded=encoded, bits=16, **SMOOTH)  # rolled, so that edges cross dots in all ways
        corners = fit_corners(through_lens(photographs(case, [0])[0]), true_corners(case, 0))
        sizes.append([np.linalg.norm(corners[1] - corners[0]), np.linalg.norm(corners[2] - corners[0])])
    # A dot covered to c shines c^γ: with c evenly spread, 1/2 − 1/(γ+1) of a dot is lost on either side. An edge that is turned by
    # 10° covers dots a little less evenly: it crosses (cos + sin) of one, two shares of which are ramps.
    lost = np.subtract(*sizes)
    assert lost == pytest.approx(2 * DOT_PX * (1 / 2 - 1 / 3.2), rel=0.1)


def test_a_grid_between_the_dots_takes_no_light_away():
    full, grid = (photographs(plate(fill_factor=share, background=1.0), [0])[0].layers["direct_diffuse"] for share in (1.0, 0.5))
    assert grid[:30].mean() == pytest.approx(full[:30].mean(), rel=2e-3)
    assert grid[:30].std() > 0.02  # but it is there, and beats with the pixels


def shadowed(*, drawn: bool) -> Scenario:
    """A small box before the plate, with the sun aside; its shadow falls on the plate."""
    parts = [box((0.1, 10.0, 3.0), name="plate"), box((1.0, 1.0, 1.0), name="post", centre_m=(0.55, 0.0, 0.0))]
    return with_changes(plate(cast_shadows=drawn), target={"parts": parts})


def test_shadows_are_drawn_where_they_are_asked_for_and_the_mask_says_so():
    without, with_them = (photographs(shadowed(drawn=drawn), [0])[0].layers for drawn in (False, True))
    assert np.array_equal(without["part_id"], with_them["part_id"])
    on_plate = inside(without["part_id"] == 1)
    cast = on_plate & ((with_them["mask"] & np.uint32(Light.CAST_SHADOW)) > 0)
    assert cast.sum() > 100
    assert not (without["mask"] & np.uint32(Light.CAST_SHADOW)).any()
    assert ((without["mask"][on_plate] & np.uint32(Light.LIT)) > 0).all()
    dark, bright = with_them["direct_diffuse"][inside(cast, 2)], without["direct_diffuse"][inside(cast, 2)]
    assert dark == pytest.approx(0.5 * 0.1, rel=0.03)  # the ambient share alone, to half a level
    assert bright == pytest.approx(0.5 * (0.1 + 0.9 * -SUN[2]), rel=0.01)
    # The post stands 1 m before the plate: towards (−0.35, 0.5) / 0.8 of a metre its shadow's end lies.
    rows, columns = np.nonzero(cast)
    assert (columns.mean() - 199.5) < -5
    assert (rows.mean() - 59.5) > 5


def test_what_is_turned_away_from_the_light_shows_the_ambient_share():
    case = with_changes(plate(), lights={"sun": {"type": "sun", "direction": (0.0, 0.1, 1.0)}})
    layers = photographs(case, [0])[0].layers
    on_plate = inside(layers["part_id"] == 1)
    assert ((layers["mask"][on_plate] & np.uint32(Light.ATTACHED_SHADOW)) > 0).all()
    assert layers["direct_diffuse"][on_plate] == pytest.approx(0.05, rel=0.03)
    assert not layers["unshadowed"].any()


def test_layers_are_those_of_the_virtual_target_and_make_the_picture():
    case = plate("y", 20.0, cam=GUPPY | {"detector": GUPPY["detector"] | {"psf_sigma_px": 0.5}}, **SMOOTH)
    photo = photographs(case, [0])[0]
    layers = photo.layers
    for name in ("direct_specular", "indirect", "indirect_raw"):
        assert not layers[name].any()
    on_plate = inside(layers["part_id"] == 1)
    rows = np.nonzero(on_plate)[0]
    z = 100.0 + np.tan(np.radians(20.0)) * (rows - 59.5) * 0.264e-3 / 0.61579 / DOT_PX * 100.0  # its lower edge is farther
    found = layers["z_m"][on_plate].astype(np.float64)
    assert min(np.abs(found - z).max(), np.abs(found - (200.0 - z)).max()) < 0.05
    assert np.abs(layers["normal.z"][on_plate] + np.cos(np.radians(20.0))).max() < 1e-5
    assert (layers["coverage"][on_plate] == 1).all()
    assert (layers["unshadowed"] <= layers["coverage"] + 1e-6).all()
    cam = case.cameras["cam"]
    rate = photometry(cam, case.radiance_spectrum).electrons_per_radiance
    inner = np.s_[8:-8, 8:-8]  # what stands beside the picture is blurred in, too
    charge = blurred(layers["direct_diffuse"], 0.5) * rate * photo.exposure_s
    by_recipe = np.floor(charge * 0.04 + 6.5)
    assert (np.abs(photo.pixels[inner] - by_recipe[inner]) <= 1).all()
    assert (photo.pixels[inner] == by_recipe[inner]).mean() > 0.999
    assert photo.truth["visible_fraction"] == 1.0
    assert photo.truth["lit_fraction"] == 1.0


def test_a_target_that_reaches_over_the_screen_is_seen_in_part():
    case = plate(dots=(100, 100))
    photo = photographs(case, [0])[0]
    assert photo.truth["visible_fraction"] == pytest.approx(100 / (10.0 / 99.9995 * screen_of(case).focal_dots), abs=0.01)
    assert (photo.layers["part_id"] > 0).sum() == pytest.approx(100 * 70 * DOT_PX**2, rel=0.02)


def test_exposure_goes_by_what_the_screen_shows():
    auto = {"exposure": {"type": "auto", "percentile": 50.0, "target_fraction": 0.5, "shortest_s": 1e-5}}
    photos = [photographs(plate(cam=GUPPY | auto, radiance_w_m2_sr=watts), [0])[0] for watts in (0.5, 2.0)]
    assert photos[0].exposure_s == pytest.approx(4 * photos[1].exposure_s, rel=1e-6)
    for photo in photos:
        assert np.median(photo.pixels[photo.layers["part_id"] > 0]) == pytest.approx(6 + 0.5 * 249, abs=1)


@pytest.mark.parametrize(("watts", "says"), [(1e-6, "no light that the camera could see"), (100.0, "saturates all that is lit")])
def test_a_screen_too_dark_or_too_bright_for_the_exposure_is_refused(watts: float, says: str):
    case: Any = plate(cam=GUPPY, radiance_w_m2_sr=watts)
    with pytest.raises(UsageError, match=says):
        plan(case, range(12))
    assert plan(plate(cam=GUPPY), range(12)).warnings == ()


def test_metals_and_coats_are_drawn_as_matt_greys():
    coat = {"type": "coated", "source": "test", "base_reflectance": 0.3, "roughness": 0.1}
    metal = {"type": "metal", "source": "test", "n": 1.0, "k": 6.0, "roughness": 0.05}
    reflectance = 36 / 40  # ((n−1)² + k²) / ((n+1)² + k²)
    for material, grey in ((LAMBERT, 0.5), (coat, 0.3), (metal, reflectance)):
        case = with_changes(plate(bits=16), target={"parts": [box((0.001, 10.0, 3.0), material)]})
        layers = photographs(case, [0])[0].layers
        assert layers["direct_diffuse"][60, 200] == pytest.approx(grey * (0.1 + 0.9 * -SUN[2]), rel=1e-3)
