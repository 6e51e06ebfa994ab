"""A quick look whether something like an ellipse is there: the gradient of a coarse picture across it.

Used where hundreds of ellipses are asked about and only the best few are looked at properly.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.pictures import Float32s
from estimators.stereo_ring.refine import stations_on
from scenes.arrays import Floats

_STATIONS = 90
_SHRINK = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """Gradient (h, w) float32 along u and v, DN per pixel of the whole picture, of a picture of half its size."""

    along_u: Float32s
    along_v: Float32s

    def support(self, ellipses: Floats, full_dn: float) -> Floats:
        """(k,) for (x, y, a, b, θ) (k, 5): the mean |gradient along the normal|, each station's cut at ``full_dn``, over it.

        0 where the ellipse is none or lies by half outside the picture.
        """
        real = np.asarray(np.isfinite(ellipses).all(axis=-1))
        stations, normals = stations_on(np.where(real[:, None], ellipses, 1.0), _STATIONS)
        at = (((stations + 0.5) * _SHRINK) - 0.5).astype(np.float32)
        u, v = (cv2.remap(part, at[..., 0], at[..., 1], cv2.INTER_LINEAR) for part in (self.along_u, self.along_v))
        across = np.abs(u * normals[..., 0] + v * normals[..., 1])
        return np.where(real, np.mean(np.minimum(across / full_dn, 1.0), axis=-1), 0.0)


def slopes(picture: NDArray[np.uint8], sigma_px: float) -> Slopes:
    """Of the whole picture (h, w), after a Gaussian of ``sigma_px`` (pixels of the whole picture)."""
    half = cv2.resize(picture, None, fx=_SHRINK, fy=_SHRINK, interpolation=cv2.INTER_AREA)
    blurred = cv2.GaussianBlur(half, (0, 0), sigma_px * _SHRINK)
    scale = _SHRINK / 32.0  # Scharr's weights sum to 32 over two pixels of half size
    u = cv2.Scharr(blurred, cv2.CV_32F, 1, 0, scale=scale)
    v = cv2.Scharr(blurred, cv2.CV_32F, 0, 1, scale=scale)
    return Slopes(np.asarray(u, dtype=np.float32), np.asarray(v, dtype=np.float32))
