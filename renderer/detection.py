"""From photo-electrons to digital numbers: the EMVA 1288 linear camera model (release 4.0, section 2)."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.camera import Camera
from scenes.detector import AutoExposure, Detector
from scenes.exr import Window
from scenes.provenance import stream

Pixels = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class FixedPattern:
    """What is the same in every frame of one camera: pixel gain (h, w), mean 1, and dark offset (h, w) in electrons."""

    gain: Pixels
    offset_e: Pixels


def fixed_pattern(camera: Camera, name: str, seed: int) -> FixedPattern:
    """The pattern of the camera called ``name`` in the data set of ``seed``: Gaussian PRNU and DSNU."""
    shape, detector = (camera.height_px, camera.width_px), camera.detector
    gain = stream(seed, 0, f"{name}.prnu").standard_normal(shape, dtype=np.float32)
    offset = stream(seed, 0, f"{name}.dsnu").standard_normal(shape, dtype=np.float32)
    return FixedPattern(1 + np.float32(detector.prnu) * gain, np.float32(detector.dsnu_e) * offset)


def exposure_time_s(camera: Camera, electron_rate: Pixels, on_target: NDArray[np.bool_]) -> float:
    """The exposure of one frame: as given, or so that a percentile of the target's pixels reaches its part of full scale.

    ``electron_rate`` (h, w) in electrons/s without noise, ``on_target`` (h, w). Without light on the target it is the longest.
    """
    rule = camera.exposure
    if not isinstance(rule, AutoExposure):
        return rule.time_s
    bright = float(np.percentile(electron_rate[on_target], rule.percentile)) if on_target.any() else 0.0
    wanted = rule.target_fraction * full_scale_e(camera.detector)
    return float(np.clip(wanted / bright if bright > 0 else np.inf, rule.shortest_s, rule.longest_s))


def full_scale_e(detector: Detector) -> float:
    """Electrons at which the signal saturates: the full well or the end of the converter's scale, whichever comes first."""
    return min(detector.full_well_e, (detector.white_dn - detector.black_level_dn) / detector.gain_dn_per_e)


def detect(
    electrons: Pixels, window: Window, camera: Camera, exposure_s: float, pattern: FixedPattern, rng: np.random.Generator
) -> NDArray[Any]:
    """The picture (height, width) in DN, uint8 up to 8 bits, else uint16.

    ``electrons``: mean photo-electrons in ``window`` (dark outside). Photo- and dark electrons are Poisson, the well is full
    at its capacity, dark offset and read noise are added, then gain, black level and the converter's rounding.
    """
    detector = camera.detector
    charge = _charge(electrons, window, camera, exposure_s, pattern, rng)
    if detector.dsnu_e:
        charge += pattern.offset_e
    if detector.read_noise_e:
        noise = rng.standard_normal(charge.shape, dtype=np.float32)
        noise *= np.float32(detector.read_noise_e)
        charge += noise
    charge *= np.float32(detector.gain_dn_per_e)
    charge += np.float32(detector.black_level_dn + 0.5)  # the converter rounds half up
    np.clip(charge, 0, detector.white_dn, out=charge)
    return charge.astype(np.uint8 if detector.bits <= 8 else np.uint16)  # truncation completes the rounding


def _charge(
    electrons: Pixels, window: Window, camera: Camera, exposure_s: float, pattern: FixedPattern, rng: np.random.Generator
) -> Pixels:
    """Electrons in each pixel's well after the exposure."""
    detector = camera.detector
    dark = detector.dark_current_e_s * exposure_s
    photo = electrons * pattern.gain[window.slices] if detector.prnu else electrons
    shape = (camera.height_px, camera.width_px)
    if detector.shot_noise:
        charge = _dark_charge(shape, min(dark, 2 * detector.full_well_e + 100), rng)
        # Beyond the well's capacity all draws end at it; far beyond, there is no Poisson generator.
        most = detector.full_well_e + 10 * np.sqrt(detector.full_well_e) + 100
        charge[window.slices] = rng.poisson(np.clip(photo + dark, 0, most))
    else:
        charge = np.full(shape, dark, dtype=np.float32)
        charge[window.slices] = photo + np.float32(dark)
    return np.minimum(charge, np.float32(detector.full_well_e), out=charge)


def _dark_charge(shape: tuple[int, int], dark_e: float, rng: np.random.Generator) -> Pixels:
    """Poisson with one mean everywhere.

    Where events are rare it draws their total and strews them: a Poisson process split evenly is Poisson in each part.
    """
    pixels = shape[0] * shape[1]
    if dark_e > 0.1:
        return rng.poisson(dark_e, shape).astype(np.float32)
    places = rng.integers(pixels, size=rng.poisson(dark_e * pixels))
    return np.bincount(places, minlength=pixels).astype(np.float32).reshape(shape)
