"""The paper's image processing: Canny edges (Canny 1986) and the standard Hough transform (Duda & Hart 1972)."""

import cv2
import numpy as np
from numpy.typing import NDArray

from estimators.mono_rectangle.parameters import PaperParameters
from estimators.mono_rectangle.quadrilateral import edge_ends
from scenes.arrays import Floats

_MARGIN_PX = 4


def hough_lines(pixels: NDArray[np.uint8], vertices_px: Floats, band_px: float, parameters: PaperParameters) -> list[Floats | None]:
    """For each edge of the expected ``vertices_px`` (4, 2): two points (2, 2) px on the strongest line in its band.

    Votes come from Canny pixels within ``band_px`` of the expected edge; a line counts if its direction is within
    ``turn_deg`` of the expected one. None where there is no such line, or the edge lies outside the picture.
    """
    corner, window = _window(pixels, vertices_px, band_px)
    if window.size == 0:
        return [None] * 4
    contours = cv2.Canny(window, parameters.canny_low_dn, parameters.canny_high_dn)
    return [_strongest(contours, ends - corner, corner, band_px, parameters) for ends in edge_ends(vertices_px)]


def _window(pixels: NDArray[np.uint8], vertices_px: Floats, band_px: float) -> tuple[Floats, NDArray[np.uint8]]:
    """The part of the picture that holds all bands, and its upper left pixel."""
    height, width = pixels.shape
    low = np.clip(np.floor(vertices_px.min(axis=0) - band_px - _MARGIN_PX), 0, None).astype(int)
    high = np.clip(np.ceil(vertices_px.max(axis=0) + band_px + _MARGIN_PX), -1, [width - 1, height - 1]).astype(int)
    window = pixels[low[1] : max(high[1] + 1, low[1]), low[0] : max(high[0] + 1, low[0])]
    return low.astype(np.float64), np.ascontiguousarray(window)


def _strongest(
    contours: NDArray[np.uint8], ends: Floats, corner: Floats, band_px: float, parameters: PaperParameters
) -> Floats | None:
    band = np.zeros_like(contours)
    first, second = ((round(x), round(y)) for x, y in ends.tolist())
    cv2.line(band, first, second, 255, thickness=int(2 * band_px) + 1)
    step = np.deg2rad(parameters.theta_deg)
    found = cv2.HoughLines(cv2.bitwise_and(contours, band), parameters.rho_px, step, parameters.votes)
    expected = np.arctan2(ends[1, 1] - ends[0, 1], ends[1, 0] - ends[0, 0]) + np.pi / 2
    for rho, theta in [] if found is None else np.reshape(found, (-1, found.shape[-1]))[:, :2].astype(np.float64):
        turned = abs((theta - expected + np.pi / 2) % np.pi - np.pi / 2)
        if turned <= np.deg2rad(parameters.turn_deg):
            normal = np.array([np.cos(theta), np.sin(theta)])
            along = np.array([-normal[1], normal[0]])
            return np.asarray(np.stack([rho * normal, rho * normal + 100 * along]) + corner)
    return None
