"""Where, along a line across an edge, a smoothed picture changes fastest: to a fraction of a pixel."""

from dataclasses import dataclass

import numpy as np

from estimators.stereo_ring.pictures import Float32s, Smoothed
from scenes.arrays import Bools, Floats

STEP_PX = 0.5  # between samples along the line: half the smoothing, so that the parabola through three is good to 0.01 px


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
    if isinstance(reach_px, np.ndarray):
        beyond = np.abs(distance_px) > reach_px[..., None, None] + STEP_PX
        gradient = np.where(beyond, np.float32(0), gradient)
    return peaks_in(gradient, distance_px, least_gradient, first)


def profile_gradients(picture: Smoothed, stations_px: Floats, normals: Floats, reach_px: float) -> tuple[Float32s, Floats]:
    """Gradients (..., n, m) DN a pixel along the normals and their distances (m,) px from the stations."""
    steps = int(np.ceil(reach_px / STEP_PX)) + 2  # one beyond for the difference, one to see that the last is no peak
    offsets = np.arange(-steps, steps + 1) * STEP_PX
    shape = stations_px.shape[:-1]
    points = stations_px.reshape(-1, 1, 2) + offsets[:, None] * normals.reshape(-1, 1, 2)
    values = picture.at(points).reshape(*shape, offsets.size)
    gradient = (values[..., 2:] - values[..., :-2]) / np.float32(2 * STEP_PX)
    return np.asarray(gradient, dtype=np.float32), np.asarray(offsets[1:-1], dtype=np.float64)


def peaks_in(gradient: Float32s, distance_px: Floats, least_gradient: float, first: bool = False) -> Peaks:
    """The largest (or first) |gradient| of each profile (..., n, m), a parabola through it and its neighbours (m ≥ 3)."""
    strength = np.abs(gradient)
    inner = strength[..., 1:-1]
    if first:
        steep = (inner >= least_gradient) & (inner >= strength[..., :-2]) & (inner > strength[..., 2:])
        best = np.argmax(steep, axis=-1)[..., None] + 1
    else:
        best = np.argmax(inner, axis=-1)[..., None] + 1
    before, peak, after = (np.take_along_axis(strength, best + k, axis=-1)[..., 0].astype(np.float64) for k in (-1, 0, 1))
    bend = before - 2 * peak + after
    local = (peak >= before) & (peak >= after) & (bend < 0)
    shift = np.where(local, 0.5 * (before - after) / np.where(local, bend, -1.0), 0.0)
    signed = np.take_along_axis(gradient, best, axis=-1)[..., 0].astype(np.float64)
    return Peaks(distance_px[best[..., 0]] + shift * STEP_PX, signed, local & (peak >= least_gradient))
