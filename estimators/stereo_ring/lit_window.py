"""Where in a picture anything is brighter than its dark: empty space need not be searched."""

import cv2
import numpy as np
from numpy.typing import NDArray

_CELL_PX = 16  # the picture is looked at in means of so many pixels squared
_DARKEST = 5.0  # per cent of the cells that stand for the dark
_SPARE_CELLS = 2


def lit_window(picture: NDArray[np.uint8], contrast_dn: float) -> tuple[slice, slice]:
    """Rows and columns around all cells that are brighter than the darkest by ``contrast_dn``; everything where none is.

    It begins at multiples of the cell's size, so that a reduced picture of it has the same pixels as one of the whole.
    """
    height, width = picture.shape
    size = (-(-width // _CELL_PX), -(-height // _CELL_PX))
    cells = cv2.resize(picture, size, interpolation=cv2.INTER_AREA).astype(np.float32)
    lit = cells >= np.percentile(cells, _DARKEST) + contrast_dn
    if not lit.any():
        return slice(0, height), slice(0, width)
    rows, columns = (_reach(lit.any(axis=axis)) for axis in (1, 0))
    return slice(rows[0], min(rows[1], height)), slice(columns[0], min(columns[1], width))


def _reach(lit: NDArray[np.bool_]) -> tuple[int, int]:
    found = np.flatnonzero(lit)
    return max(int(found[0]) - _SPARE_CELLS, 0) * _CELL_PX, (int(found[-1]) + 1 + _SPARE_CELLS) * _CELL_PX
