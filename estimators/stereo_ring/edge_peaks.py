"""Where, along a line across an edge, a smoothed picture changes fastest: to a fraction of a pixel."""

from dataclasses import dataclass

import numpy as np

from estimators.stereo_ring.pictures import Float32s, Smoothed
from scenes.arrays import Bools, Floats

STEP_PX = 0.5  # between samples along the line
_WIDE = 2  # steps of a difference to each side, and of the parabola: a pixel. With half of it, bilinear samples of a step have
# gradients with a flat top half a pixel wide, and the peak is a matter of chance; with a pixel, it is right to 0.03 px


@dataclass(frozen=True, slots=True, eq=False)
class Peaks:
    """``distance_px`` (..., n) from the station along its normal, ``gradient`` (..., n) there in DN a pixel, signed: positive
    where the picture grows brighter along the normal; ``found`` (..., n): whether there is a peak within reach and above the
    threshold."""

    distance_px: Floats
    gradient: Floats
    found: Bools


def edge_peaks(
    picture: Smoothed, stations_px: Floats, normals: Floats, reach_px: float | Floats, least_gradient: float, first: bool = False
) -> Peaks:
    """The steepest place within ``reach_px`` (one, or (...,)) of stations (..., n, 2) along unit ``normals`` (..., n, 2).

    ``first``: not the steepest, but the first that is steep enough on the way along the normal: the edge of a surface that is
    plain inside, whatever shadow lies beyond it.
    """
    gradient, distance_px = profile_gradients(picture, stations_px, normals, float(np.max(reach_px)))
    return peaks_in(gradient, distance_px, reach_px, least_gradient, first)


def profile_gradients(picture: Smoothed, stations_px: Floats, normals: Floats, reach_px: float) -> tuple[Float32s, Floats]:
    """Gradients (..., n, m) DN a pixel along the normals and their distances (m,) px from the stations."""
    steps = int(np.ceil(reach_px / STEP_PX)) + 2 * _WIDE  # room for the difference and for the parabola
    offsets = np.arange(-steps, steps + 1) * STEP_PX
    shape = stations_px.shape[:-1]
    points = stations_px.reshape(-1, 1, 2) + offsets[:, None] * normals.reshape(-1, 1, 2)
    values = picture.at(points).reshape(*shape, offsets.size)
    gradient = (values[..., 2 * _WIDE :] - values[..., : -2 * _WIDE]) / np.float32(2 * _WIDE * STEP_PX)
    return np.asarray(gradient, dtype=np.float32), np.asarray(offsets[_WIDE:-_WIDE], dtype=np.float64)


def peaks_in(
    gradient: Float32s, distance_px: Floats, reach_px: float | Floats, least_gradient: float, first: bool = False
) -> Peaks:
    """The largest (or first) |gradient| within reach in each profile (..., n, m), a parabola through it and its neighbours."""
    strength = np.abs(gradient)
    inner = strength[..., _WIDE:-_WIDE]
    within = np.abs(distance_px[_WIDE:-_WIDE]) <= np.asarray(reach_px)[..., None, None] + 1e-6
    if first:
        steep = within & (inner >= least_gradient) & (inner >= strength[..., 1:-3]) & (inner > strength[..., 3:-1])
        best = np.argmax(steep, axis=-1)[..., None] + _WIDE
    else:
        best = np.argmax(np.where(within, inner, np.float32(-1)), axis=-1)[..., None] + _WIDE
    beside = [np.take_along_axis(strength, best + k, axis=-1)[..., 0].astype(np.float64) for k in (-_WIDE, -1, 0, 1, _WIDE)]
    before, left, peak, right, after = beside
    bend = before - 2 * peak + after
    local = (peak >= left) & (peak >= right) & (bend < 0)
    shift = np.where(local, 0.5 * (before - after) / np.where(local, bend, -1.0), 0.0)
    signed = np.take_along_axis(gradient, best, axis=-1)[..., 0].astype(np.float64)
    distance = distance_px[best[..., 0]] + np.clip(shift, -1.0, 1.0) * _WIDE * STEP_PX
    return Peaks(distance, signed, local & (peak >= least_gradient))
