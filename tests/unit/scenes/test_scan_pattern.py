"""Patterns cover the field that they state, and fire their beams in a sensible order."""

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from scenes.scan_pattern import Flash, Raster, Rosette, ScanPattern, half_field_rad

FLASH = Flash(type="flash", columns=64, rows=32, field_deg=(20.0, 10.0))
RASTER = Raster(type="raster", columns=41, rows=21, field_deg=(40.0, 20.0), scan_s=2.0)
ROSETTE = Rosette(type="rosette", beams_per_scan=20000, deflection_deg=(9.0, 6.0), turns_hz=(121.0, -77.0), scan_s=0.1)


@pytest.mark.parametrize("pattern", [FLASH, RASTER, ROSETTE])
def test_directions_are_unit_vectors_in_the_shape_of_a_scan(pattern):
    beams = pattern.beams
    assert beams.directions_lidar.shape == (*pattern.shape, 3)
    assert beams.time_s.shape == pattern.shape
    assert np.abs(np.linalg.norm(beams.directions_lidar, axis=-1) - 1).max() < 1e-12
    assert (beams.directions_lidar[..., 2] > 0).all()
    assert np.ptp(beams.time_s) == pytest.approx(pattern.duration_s)
    assert beams.time_s.max() == pytest.approx(pattern.duration_s / 2)
    assert not beams.directions_lidar.flags.writeable


def angles_deg(pattern) -> tuple[np.ndarray, np.ndarray]:
    """Horizontal and vertical angle of each beam, as a person would measure them."""
    x, y, z = np.moveaxis(pattern.beams.directions_lidar, -1, 0)
    return np.degrees(np.arctan2(x, z)), np.degrees(np.arcsin(y) if isinstance(pattern, Raster) else np.arctan2(y, z))


def test_a_flash_has_its_outermost_pixels_end_at_the_field():
    across, down = (np.tan(np.radians(angle)) for angle in angles_deg(FLASH))
    for angle, count, deg in ((across[0], 64, 20.0), (down[:, 0], 32, 10.0)):
        steps = np.diff(angle)
        assert steps == pytest.approx(2 * np.tan(np.radians(deg / 2)) / count)  # equal steps of the tangent, as behind a lens
        assert angle[-1] + steps[0] / 2 == pytest.approx(np.tan(np.radians(deg / 2)))
        assert angle == pytest.approx(-angle[::-1])


def test_a_raster_reaches_from_end_to_end_of_its_field():
    across, down = angles_deg(RASTER)
    assert across[0] == pytest.approx(np.linspace(-20, 20, 41))
    assert down[:, 0] == pytest.approx(np.linspace(-10, 10, 21))


def test_rows_run_down_and_columns_to_the_right():
    for pattern in (FLASH, RASTER):
        directions = pattern.beams.directions_lidar
        assert directions[0, 0, 0] < directions[0, -1, 0]
        assert directions[0, 0, 1] < directions[-1, 0, 1]


def test_a_raster_s_times_grow_along_its_sweep():
    there = RASTER.beams.time_s
    assert (np.diff(there.ravel()) > 0).all()
    both_ways = RASTER.model_copy(update={"bidirectional": True}).beams
    assert (np.diff(both_ways.time_s[0]) > 0).all()
    assert (np.diff(both_ways.time_s[1]) < 0).all()
    fired = np.argsort(both_ways.time_s.ravel())
    path = both_ways.directions_lidar.reshape(-1, 3)[fired]
    jump = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert jump.max() < 1.01 * np.radians(1.0)  # no fly-back: neighbours in time are neighbours in space
    assert np.array_equal(both_ways.directions_lidar, RASTER.beams.directions_lidar)


def test_a_rosette_fills_a_disk_between_the_difference_and_the_sum_of_its_bends():
    off = np.degrees(np.arccos(ROSETTE.beams.directions_lidar[0, :, 2]))
    assert off.max() == pytest.approx(15.0, abs=0.01)
    assert off.min() == pytest.approx(3.0, abs=0.01)
    assert np.degrees(half_field_rad(ROSETTE)) == pytest.approx(15.0, abs=0.01)
    azimuth = np.arctan2(ROSETTE.beams.directions_lidar[0, :, 1], ROSETTE.beams.directions_lidar[0, :, 0])
    assert np.histogram(azimuth, bins=36)[0].min() > 0.8 * 20000 / 36
    assert (np.diff(ROSETTE.beams.time_s) > 0).all()


def test_one_pulse_serves_a_flash_and_one_beam_the_others():
    assert (FLASH.beams.pulses, RASTER.beams.pulses, ROSETTE.beams.pulses) == (1, 41 * 21, 20000)


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"type": "flash", "columns": 0, "rows": 4, "field_deg": (1.0, 1.0)}, "greater than or equal to 1"),
        ({"type": "flash", "columns": 4, "rows": 4, "field_deg": (180.0, 1.0)}, "less than 150"),
        ({"type": "raster", "columns": 4, "rows": 4, "field_deg": (10.0, 1.0), "scan_s": 0.0}, "greater than 0"),
        (
            {"type": "rosette", "beams_per_scan": 9, "deflection_deg": (3.0, 3.0), "turns_hz": (5.0, 5.0), "scan_s": 1.0},
            "draw a circle",
        ),
        ({"type": "spiral"}, "spiral"),
    ],
)
def test_what_no_pattern_can_be_is_refused(changes, fault):
    with pytest.raises(ValidationError, match=fault):
        TypeAdapter(ScanPattern).validate_python(changes)
