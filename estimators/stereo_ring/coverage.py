"""Step 5 of section 2.3.1: does the gradient stand on the ellipse all the way round, and where exactly.

A sample of the ellipse is covered if within ``distance_px`` the gradient is strong enough and along the ellipse's normal. The
coverage of "same" polarity counts the more frequent of the two senses only, that of "any" both.
"""

from dataclasses import dataclass

import numpy as np

from estimators.stereo_ring.arcs import peak_offset
from estimators.stereo_ring.conics import conics_from_parameters, sampson_px
from estimators.stereo_ring.detector_parameters import DetectorParameters
from estimators.stereo_ring.ellipse_fits import direct_fits, point_scatter
from estimators.stereo_ring.segments import Reduced
from scenes.arrays import Bools, Floats

_QUICK, _FULL, _FINE = 30, 90, 120  # samples: to dismiss, to judge, to refit
_FIRST_SHARE, _QUICK_SHARE = 0.4, 0.7  # of the coverage asked for, to be looked at again
_REACH = 3  # reduced pixels across, when refitting
_INLIER_PX = 1.5  # reduced pixels from the ellipse, when refitting


@dataclass(frozen=True, slots=True, eq=False)
class Covered:
    """``ellipses`` (n, 5) reduced pixels, ``coverage`` (n,), ``bright_inside`` (n,) in [−1, 1], ``rms`` (n,) reduced pixels."""

    ellipses: Floats
    coverage: Floats
    bright_inside: Floats
    rms: Floats

    def taken(self, index: np.ndarray) -> "Covered":
        """Those at ``index``."""
        return Covered(self.ellipses[index], self.coverage[index], self.bright_inside[index], self.rms[index])


def promising(picture: Reduced, ellipses: Floats, parameters: DetectorParameters) -> Floats:
    """Of the ellipses (n, 5), those at first sight best covered, at least by part of what is asked for."""
    quick, _ = coverage_of(picture, ellipses, parameters, _QUICK)
    best = np.argsort(-quick, kind="stable")[: parameters.most_grown]
    return np.asarray(ellipses[best[quick[best] >= _FIRST_SHARE * parameters.min_coverage]])


def verified(picture: Reduced, ellipses: Floats, parameters: DetectorParameters) -> Covered:
    """The ellipses (n, 5) that are covered nearly as far as is asked for."""
    coverage, sense = coverage_of(picture, ellipses, parameters, _FULL)
    unknown = np.full(len(ellipses), np.nan)
    return Covered(ellipses, coverage, sense, unknown).taken(np.flatnonzero(coverage >= _QUICK_SHARE * parameters.min_coverage))


def coverage_of(picture: Reduced, ellipses: Floats, parameters: DetectorParameters, samples: int) -> tuple[Floats, Floats]:
    """Covered share (n,) of ellipses (n, 5), and how bright their inside is: +1 all round, −1 nowhere."""
    reach = parameters.distance_px * picture.scale
    offsets = np.linspace(-reach, reach, 2 * int(np.ceil(reach)) + 1)
    slope, strength = _slopes(picture, ellipses, samples, offsets)
    stands = _stands(slope, strength, parameters, picture.scale)
    brighter, darker = ((stands & (slope * sign < 0)).any(axis=2).mean(axis=1) for sign in (1, -1))
    either = stands.any(axis=2).mean(axis=1)
    sense = (brighter - darker) / np.maximum(brighter + darker, 1e-9)
    return np.maximum(brighter, darker) if parameters.polarity == "same" else either, sense


def refitted(plain: Reduced, picture: Reduced, found: Covered, parameters: DetectorParameters, rounds: int = 2) -> Covered:
    """The ellipses drawn onto the gradient's peaks beside them, each with the rms distance of the peaks that it explains.

    The peaks are those of ``plain``, in DN as they are; the coverage is that of ``picture``.
    """
    ellipses, offsets = found.ellipses, np.arange(-_REACH - 1.0, _REACH + 2.0)
    rms = found.rms
    for _ in range(rounds):
        points, outward = _stations(ellipses, _FINE)
        slope, strength = _slopes(plain, ellipses, _FINE, offsets)
        seen = (slope, strength) if picture is plain else _slopes(picture, ellipses, _FINE, offsets)
        stands = _stands(*seen, parameters, picture.scale)
        signed = slope * -np.sign(found.bright_inside)[:, None, None] if parameters.polarity == "same" else np.abs(slope)
        at, is_peak = peak_offset(signed[..., 1:-1], signed[..., 1:-1])
        edge = points + (at - _REACH)[..., None] * outward
        nearest = np.rint(at).astype(np.intp)[..., None] + 1
        strong = is_peak & np.take_along_axis(stands, nearest, axis=2)[..., 0]
        new, rms = _trimmed_fit(edge, strong)
        ellipses = np.where(np.isfinite(new), new, ellipses)
    coverage, sense = coverage_of(picture, ellipses, parameters, _FULL)
    return Covered(ellipses, coverage, sense, rms)


def _stands(slope: Floats, strength: Floats, parameters: DetectorParameters, scale: float) -> Bools:
    """Where the gradient is strong enough and along the normal."""
    steep = np.abs(slope) >= np.cos(np.radians(parameters.normal_tolerance_deg)) * strength
    return np.asarray(steep & (strength >= parameters.min_gradient_dn_px / scale))


def _trimmed_fit(edge: Floats, usable: Bools) -> tuple[Floats, Floats]:
    """Direct fits (n, 5) to edge points (n, k, 2), the second time without those that are off the first; rms (n,) of the rest."""
    kept = usable
    fitted, rms = direct_fits(*point_scatter(edge, kept.astype(np.float64)))
    for limit in (2 * _INLIER_PX, _INLIER_PX):
        distance = np.abs(sampson_px(np.nan_to_num(conics_from_parameters(fitted)), edge))
        kept = usable & (distance <= limit) & np.isfinite(fitted).all(axis=1, keepdims=True)
        fitted, rms = direct_fits(*point_scatter(edge, kept.astype(np.float64)))
    return fitted, rms


def _slopes(picture: Reduced, ellipses: Floats, samples: int, offsets: Floats) -> tuple[Floats, Floats]:
    """The gradient's component along the outward normal, and its length, (n, samples, offsets)."""
    points, outward = _stations(ellipses, samples)
    across = points[:, :, None] + offsets[:, None] * outward[:, :, None]
    gradient = picture.sampled(across)
    return np.einsum("nkoc,nkc->nko", gradient, outward), np.hypot(gradient[..., 0], gradient[..., 1])


def _stations(ellipses: Floats, samples: int) -> tuple[Floats, Floats]:
    """Points (n, samples, 2) on the ellipses and the outward unit normals there."""
    x, y, a, b, theta = (one[:, None] for one in ellipses.T)
    t = np.arange(samples) * (2 * np.pi / samples)
    c, s, ct, st = np.cos(theta), np.sin(theta), np.cos(t), np.sin(t)
    points = np.stack([x + c * a * ct - s * b * st, y + s * a * ct + c * b * st], axis=-1)
    normal = np.stack([c * b * ct - s * a * st, s * b * ct + c * a * st], axis=-1)
    return points, normal / np.linalg.norm(normal, axis=-1, keepdims=True)
