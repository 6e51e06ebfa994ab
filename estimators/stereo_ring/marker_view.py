"""What a view shows of one marker: its plain inside, the first edge on the way out, and where a narrow shadow lies on that edge."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.edge_peaks import STEP_PX, Peaks, peaks_in, profile_gradients
from estimators.stereo_ring.marker_parameters import MarkerParameters
from estimators.stereo_ring.pictures import Smoothed, smoothed
from estimators.stereo_ring.robust import MAD_TO_SIGMA
from scenes.arrays import Bools, Floats


@dataclass(frozen=True, slots=True, eq=False)
class MarkerView:
    """A view twice: ``smooth`` for the place of edges, ``raw`` for narrow shadows."""

    smooth: Smoothed
    raw: Smoothed


def marker_view(picture: NDArray[np.uint8], centre_px: Floats, half_px: float, p: MarkerParameters) -> MarkerView:
    """The square of half-width ``half_px`` about ``centre_px`` (2,) of an eight-bit picture (h, w)."""
    smooth = smoothed(picture, centre_px, half_px, p.smooth_sigma_px)
    return MarkerView(smooth, smoothed(picture, centre_px, half_px, 0.0))


@dataclass(frozen=True, slots=True, eq=False)
class Inside:
    """What is plain: the marker's brightness, DN, its ``noise_dn``, and the ``least_gradient`` that is an edge."""

    level_dn: float
    noise_dn: float
    least_gradient: float


def inside_of(view: MarkerView, border_px: Floats, p: MarkerParameters) -> Inside:
    """Of the inner half of a border (n, 2). More is an edge in a bright marker, whose photon noise is larger."""
    middle = border_px.mean(axis=0)
    around = np.concatenate([middle + share * (border_px - middle) for share in (0.15, 0.3, 0.45, 0.6)])
    values = view.raw.at(np.concatenate([around, (around + np.roll(around, 1, axis=0)) / 2])[None])[0].astype(np.float64)
    level = float(np.median(values))
    noise = MAD_TO_SIGMA * float(np.median(np.abs(values - level)))
    return Inside(level, noise, max(p.least_gradient_dn, p.least_gradient_share * level, p.least_gradient_noise * noise))


def marker_edges(
    view: MarkerView, stations: Floats, normals: Floats, window_px: float, inside: Inside, p: MarkerParameters
) -> tuple[Peaks, Bools]:
    """The first edge outwards at stations (..., n, 2), and at which (..., n) no narrow shadow lies on it."""
    gradient, distance = profile_gradients(view.smooth, stations, normals, window_px + p.strip_px)
    peaks = peaks_in(gradient, distance, window_px, inside.least_gradient, first=True)
    beyond = distance - peaks.distance_px[..., None]
    beside = (beyond > STEP_PX) & (beyond <= p.strip_px)
    other_side = np.where(beside, -np.sign(peaks.gradient)[..., None] * gradient, 0.0).max(axis=-1)
    before = peaks.distance_px[..., None] - np.arange(0.25, p.dip_px, STEP_PX)
    dark = view.raw.at(stations[..., None, :] + before[..., None] * normals[..., None, :]).min(axis=-1)
    dipped = dark < inside.level_dn - max(p.dip_sigmas * inside.noise_dn, p.dip_dn)
    return peaks, np.asarray(peaks.found & ~dipped & (other_side <= np.abs(peaks.gradient)))
