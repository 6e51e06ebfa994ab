"""What one digital number tells of the mean number of photo-electrons behind it: exact Fisher information of the detector."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr
from scipy.stats import poisson

from scenes.arrays import Floats, frozen
from scenes.detector import Detector

_MEANS = 60  # support of the table, dense where the information bends: at few electrons and at the full well
_TAIL = 6.5  # standard deviations of the charge that are summed over


@dataclass(frozen=True, slots=True, eq=False)
class DigitalInformation:
    """A table of w(μ) in 1/e², for means ``mean_e`` (n,) of photo-electrons.

    w(μ) = Σ_k (∂p_k/∂μ)² / p_k over the digital numbers k, p_k = P(k | μ) (Kay, Estimation Theory, 1993, eq. 3.6 for a discrete
    variable).
    """

    mean_e: Floats
    weight: Floats

    def __call__(self, mean_e: Floats) -> Floats:
        """w at any means (…); 1/w, which is a variance and nearly straight in μ, is interpolated. Beyond the ends the end's."""
        return np.asarray(1 / np.interp(mean_e, self.mean_e, 1 / np.maximum(self.weight, 1e-30)))


def digital_information(detector: Detector, exposure_s: float) -> DigitalInformation:
    """The table of a detector at one exposure: shot and dark noise, full well, dark offset, read noise, rounding, both ends.

    A pixel's gain and dark offset are not known to an estimator that has one frame, so they are noise here: the offset as part of
    the read noise, the gain as σ = prnu · μ.
    """
    means = _support(detector)
    return DigitalInformation(frozen(means), frozen([_weight(detector, float(mean), exposure_s) for mean in means]))


def _support(detector: Detector) -> Floats:
    """0, then √μ-spaced means to well above what saturates, with more of them around the full well."""
    full = min(detector.full_well_e, (detector.white_dn - detector.black_level_dn) / detector.gain_dn_per_e)
    spread = np.sqrt(full + detector.read_noise_e**2)
    coarse = np.linspace(0.0, np.sqrt(full + 20 * spread), _MEANS) ** 2
    return np.unique(np.concatenate([coarse, full + spread * np.linspace(-8, 8, _MEANS // 2)]).clip(min=0))


def _weight(detector: Detector, mean_e: float, exposure_s: float) -> float:
    """w at one mean. Chances are summed over charges first, below each edge, and differenced over the edges afterwards."""
    dark_e, sigma_e = detector.dark_current_e_s * exposure_s, _added_sigma_e(detector, mean_e)
    if detector.shot_noise:
        charges, chance, slope = _shot(mean_e, dark_e)
        below = _below(_edges_e(detector, charges, sigma_e), charges, sigma_e, detector.full_well_e)
        total, moved = chance @ below, slope @ below
    else:
        step = 1e-3 * sigma_e
        charges = mean_e + dark_e + np.array([-step, 0.0, step])
        low, total, high = _below(_edges_e(detector, charges, sigma_e), charges, sigma_e, detector.full_well_e)
        moved = (high - low) / (2 * step)
    p = np.diff(total, prepend=0.0, append=1.0)
    dp = np.diff(moved, prepend=0.0, append=0.0)
    seen = p > 1e-30
    return float(np.sum(dp[seen] ** 2 / p[seen]))


def _shot(mean_e: float, dark_e: float) -> tuple[Floats, Floats, Floats]:
    """Numbers of electrons, their Poisson chance, and its derivative ∂P(n)/∂μ = P(n − 1) − P(n)."""
    total = mean_e + dark_e
    reach = _TAIL * np.sqrt(total + 1) + 10
    numbers = np.arange(max(0, int(total - reach)), int(total + reach) + 2, dtype=np.float64)
    chance = poisson.pmf(numbers, total)
    return numbers, chance, poisson.pmf(numbers - 1, total) - chance


def _added_sigma_e(detector: Detector, mean_e: float) -> float:
    """Read noise, dark offset and the unknown gain together; never zero, so that rounding alone stays differentiable."""
    variance = detector.read_noise_e**2 + detector.dsnu_e**2 + (detector.prnu * mean_e) ** 2
    return float(np.sqrt(max(variance, (0.02 / detector.gain_dn_per_e) ** 2)))


def _edges_e(detector: Detector, charges: Floats, sigma_e: float) -> Floats:
    """Charges at which the converter goes from one digital number to the next, those within reach only."""
    steps = np.arange(detector.white_dn) + 0.5
    edges = (steps - detector.black_level_dn) / detector.gain_dn_per_e
    low, high = min(charges[0], detector.full_well_e), min(charges[-1], detector.full_well_e)
    near = (edges > low - _TAIL * sigma_e) & (edges < high + _TAIL * sigma_e)
    if near.any():
        return np.asarray(edges[near], dtype=np.float64)
    return np.asarray(edges[[int(np.argmin(np.abs(edges - charges.mean())))]], dtype=np.float64)


def _below(edges_e: Floats, charges: Floats, sigma_e: float, full_well_e: float) -> Floats:
    """(charges, edges): chance that what the well holds, with noise, lies below each edge."""
    return np.asarray(ndtr((edges_e[None, :] - np.minimum(charges, full_well_e)[:, None]) / sigma_e))
