"""Filters the indirect layer only: it is smooth but noisy. Direct light, silhouettes, highlights and truth stay untouched."""

import numpy as np
from numpy.typing import NDArray

from scenes.exr import occupied

Layer = NDArray[np.float32]


def denoise_indirect(indirect: Layer, coverage: Layer) -> Layer:
    """Open Image Denoise on the radiance layer ``indirect`` (h, w), kept off the background and true to the layer's energy.

    ``coverage`` (h, w) is the fraction of each pixel that the target fills. The filter leaks light across silhouettes and
    is biased by about one per cent; both are taken back: nothing remains where nothing is, and the sum is the raw sum.
    """
    import pyoidn

    raw_sum = float(indirect.sum(dtype=np.float64))
    if raw_sum <= 0:
        return indirect
    smooth = np.zeros_like(indirect)
    here = occupied({"coverage": coverage}).slices  # the filter takes its time over empty space as well
    colour = np.repeat(indirect[here][:, :, None], 3, axis=2)
    smooth[here] = np.where(coverage[here] > 0, np.maximum(pyoidn.denoise(colour, hdr=True)[:, :, 0], 0), 0)
    smooth_sum = float(smooth.sum(dtype=np.float64))
    return smooth * np.float32(raw_sum / smooth_sum) if smooth_sum > 0 else indirect
