"""How a scan's beams lie in a picture: in rows and columns, cut out around the target, or strewn as a rosette's beams are."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.beam_fate import BeamFate
from scenes.lidar import Lidar

_MARGIN, _SMALLEST = 3, 24  # beams about the target, and across the cut-out at least
_STREWN_PX = 256
_GROUND_BGR = (24, 19, 16)


@dataclass(frozen=True, slots=True, eq=False)
class ScanGrid:
    """``rows`` and ``columns``: the cut-out; ``places`` (beams, 2): row and column in the picture where the beams are strewn."""

    rows: slice
    columns: slice
    places: NDArray[np.int64] | None = None

    def picture(self, colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """(height, width, 3) of the colours (rows, columns, 3) of the beams."""
        if self.places is None:
            return np.ascontiguousarray(colours[self.rows, self.columns])
        canvas = np.full((_STREWN_PX, _STREWN_PX, 3), _GROUND_BGR, dtype=np.uint8)
        down, across = self.places.T
        for right, below in ((0, 0), (1, 0), (0, 1), (1, 1)):  # a beam is four pixels
            canvas[np.minimum(down + below, _STREWN_PX - 1), np.minimum(across + right, _STREWN_PX - 1)] = colours[0]
        return canvas


def grid_of(lidars: Mapping[str, Any], name: str, reason: NDArray[np.uint8]) -> ScanGrid:
    """The grid of one scan, from the scenario's LIDARs and the fate of each beam (rows, columns)."""
    lidar = Lidar.model_validate(lidars[name])
    rows = lidar.pattern.shape[0]
    if rows == 1:
        directions = lidar.pattern.beams.directions_lidar[0]
        slope = directions[:, 1::-1] / directions[:, 2:]
        shown = 0.5 + 0.49 * slope / max(float(np.abs(slope).max()), 1e-12)
        return ScanGrid(slice(0, 1), slice(None), np.asarray(shown * _STREWN_PX, dtype=np.int64))
    met = reason[:rows] != BeamFate.NOTHING
    return ScanGrid(_span(met.any(axis=1)), _span(met.any(axis=0)))


def _span(there: NDArray[np.bool_]) -> slice:
    """The rows or columns between the first and the last where something is, with a margin; all where nothing is."""
    hit = np.flatnonzero(there)
    if hit.size == 0:
        return slice(0, len(there))
    missing = max(0, _SMALLEST - int(hit[-1] - hit[0] + 1)) // 2
    return slice(max(0, int(hit[0]) - _MARGIN - missing), min(len(there), int(hit[-1]) + 1 + _MARGIN + missing))
