"""Step 1 of section 2.3.1, first half: the reduced picture, its gradient, and its line segments.

The segments are those of LSD (Grompone von Gioi, Jakubowicz, Morel & Randall 2010).
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.detector_parameters import DetectorParameters
from scenes.arrays import Floats

_LSD_SIGMA, _LSD_QUANTISATION, _LSD_BINS = 0.6, 2.0, 1024
_SCHARR_SUM = 32.0
_MOST_SEGMENTS = 8000  # noise makes more


@dataclass(frozen=True, slots=True, eq=False)
class Reduced:
    """A picture made smaller by ``scale``: ``blurred`` (h, w) uint8, ``gradient`` (h, w, 2) float32 (∂u, ∂v), DN a small pixel."""

    blurred: NDArray[np.uint8]
    gradient: NDArray[np.float32]
    scale: float

    def sampled(self, points: Floats) -> Floats:
        """Gradient (n, ..., 2) at ``points`` (n, ..., 2) of the reduced picture, bilinear; zero outside."""
        if points.size == 0:
            return np.zeros(points.shape)
        flat = np.asarray(points, dtype=np.float32).reshape(len(points), -1, 2)
        found = cv2.remap(self.gradient, flat, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
        return np.asarray(found, dtype=np.float64).reshape(points.shape)


def reduced(picture: NDArray[np.uint8], parameters: DetectorParameters, root_dn: float | None = None) -> Reduced:
    """The picture at ``scale``, smoothed, with its Scharr gradient; of √(DN + ``root_dn``) if given."""
    small, scale = _levelled(picture, root_dn), parameters.scale
    if scale < 1:
        small = np.asarray(cv2.resize(small, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA))
    blurred = cv2.GaussianBlur(small, (0, 0), parameters.blur_px * scale)
    slopes = [cv2.Scharr(blurred, cv2.CV_32F, *step, scale=1 / _SCHARR_SUM) for step in ((1, 0), (0, 1))]
    return Reduced(np.asarray(blurred, dtype=np.uint8), np.asarray(cv2.merge(slopes), dtype=np.float32), scale)


def line_segments(picture: Reduced, parameters: DetectorParameters) -> Floats:
    """End points (n, 2, 2) of the segments in the reduced picture that are long enough to be halved."""
    detector = cv2.createLineSegmentDetector(
        cv2.LSD_REFINE_STD,
        1.0,
        _LSD_SIGMA,
        _LSD_QUANTISATION,
        parameters.lsd_angle_deg,
        0.0,
        parameters.lsd_density,
        _LSD_BINS,
    )
    lines = detector.detect(picture.blurred)[0]
    if lines is None:
        return np.zeros((0, 2, 2))
    ends = np.asarray(lines, dtype=np.float64).reshape(-1, 2, 2)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    longest = np.sort(np.argsort(-length, kind="stable")[:_MOST_SEGMENTS])
    return np.asarray(ends[longest[length[longest] >= parameters.min_length_px * picture.scale]])


def _levelled(picture: NDArray[np.uint8], root_dn: float | None) -> NDArray[np.uint8]:
    """The square root of the grey values, black and white kept: makes photon noise even (Anscombe 1948)."""
    if root_dn is None:
        return picture
    grey = np.sqrt(np.arange(256.0) + root_dn)
    table = np.rint((grey - grey[0]) * (255 / (grey[-1] - grey[0]))).astype(np.uint8)
    return np.asarray(cv2.LUT(picture, table), dtype=np.uint8)


def in_camera_pixels(points: Floats, scale: float) -> Floats:
    """Points of the reduced picture as the camera's pixels; both count from the centre of the first pixel."""
    return np.asarray((points + 0.5) / scale - 0.5)
