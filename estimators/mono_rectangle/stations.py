"""Where an edge is looked at: whole pixel columns (or rows) along a predicted line, so that no pixel is interpolated.

A box-filtered pixel column crossed by a straight edge holds the edge's position at the column's centre exactly; any
resampling of the picture would bias it by a few hundredths of a pixel, which is all the perspective there is.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimators.mono_rectangle.quadrilateral import normalised_from_ideal
from scenes.arrays import Bools, Floats
from scenes.intrinsics import Intrinsics

_CURVE_POINTS = 33


@dataclass(frozen=True, slots=True, eq=False)
class Stations:
    """Columns (or rows) along one predicted edge, in raw pixels.

    ``upright``: the edge runs along x and is crossed along y. ``at`` (n,) whole coordinates along the edge, ``crossing``
    (n,) where the line crosses them, ``fraction`` (n,) from the edge's first end (0) to its second (1) in the image,
    ``cosine`` (n,) pixels along the normal for a pixel along the column, ``outward`` ±1: which way is out of the rectangle.
    """

    upright: bool
    at: NDArray[np.int64]
    crossing: Floats
    fraction: Floats
    cosine: Floats
    outward: float

    def only(self, chosen: Bools) -> "Stations":
        """The stations where ``chosen`` (n,) is true."""
        return replace(
            self,
            at=self.at[chosen],
            crossing=self.crossing[chosen],
            fraction=self.fraction[chosen],
            cosine=self.cosine[chosen],
        )

    def gather(self, pixels: NDArray[np.generic], reach: int) -> tuple[Floats, Floats]:
        """Grey values (n, 2·reach+1) about the crossing, float64 DN, and their signed distance outward along the normal, px.

        Coordinates beyond the picture repeat its border.
        """
        nearest = np.rint(self.crossing).astype(np.int64)
        across = nearest[:, None] + np.arange(-reach, reach + 1)
        rows, columns = (across, self.at[:, None]) if self.upright else (self.at[:, None], across)
        height, width = pixels.shape
        inside = nearest.min() >= reach and nearest.max() + reach < (height if self.upright else width)
        if not inside:
            rows, columns = np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)
        values = pixels[rows, columns].astype(np.float64)
        return values, self.outward * (across - self.crossing[:, None]) * self.cosine[:, None]


def stations_along(
    ends_px: Floats,
    normal: Floats,
    intrinsics: Intrinsics,
    trim: tuple[float, float],
    gap: tuple[float, float] | None = None,
) -> Stations:
    """Stations on the ideal line between ``ends_px`` (2, 2), whose outward normal is ``normal`` (2,).

    ``trim`` = (fraction of the length, pixels) left out at both ends; ``gap`` = image fractions between which the edge does
    not exist. May hold no station, where the edge is too short or outside the picture.
    """
    fraction, raw = _curve(ends_px, intrinsics)
    chord = raw[-1] - raw[0]
    upright = bool(abs(chord[0]) >= abs(chord[1]))
    along, across = (raw[:, 0], raw[:, 1]) if upright else (raw[:, 1], raw[:, 0])
    at = _whole_numbers(np.interp(_kept(chord, trim), fraction, along), intrinsics.width_px if upright else intrinsics.height_px)
    order = slice(None) if along[-1] > along[0] else slice(None, None, -1)
    place = np.interp(at, along[order], fraction[order])
    if gap is not None:
        seen = (place < gap[0]) | (place > gap[1])
        at, place = at[seen], place[seen]
    slope = np.diff(across) / np.diff(along)
    piece = np.minimum((place * len(slope)).astype(np.int64), len(slope) - 1)
    return Stations(
        upright=upright,
        at=at,
        crossing=np.interp(at, along[order], across[order]),
        fraction=place,
        cosine=(1 / np.hypot(1, slope))[piece],
        outward=float(np.sign(normal[1 if upright else 0])),
    )


def _curve(ends_px: Floats, intrinsics: Intrinsics) -> tuple[Floats, Floats]:
    """Points of the ideal line where the lens shows them, (n, 2) raw px, and their fractions of the way, (n,)."""
    if not intrinsics.is_distorted:
        return np.array([0.0, 1.0]), ends_px
    fraction = np.linspace(0, 1, _CURVE_POINTS)
    ideal = ends_px[0] + fraction[:, None] * (ends_px[1] - ends_px[0])
    return fraction, intrinsics.pixels_from_normalised(normalised_from_ideal(ideal, intrinsics))


def image_fraction(fraction: float, depth_ratio: float) -> float:
    """Where in the image, as a fraction of the edge, lies the point at ``fraction`` of its true length.

    ``depth_ratio``: depth of the edge's second end over its first (a projective map of the line).
    """
    return fraction * depth_ratio / (1 - fraction + fraction * depth_ratio)


def _kept(chord: Floats, trim: tuple[float, float]) -> tuple[float, float]:
    """The fractions of an edge between which it is looked at."""
    cut = min(trim[0] + trim[1] / max(float(np.hypot(*chord)), 1.0), 0.5)
    return cut, 1 - cut


def _whole_numbers(span: Floats, size: int) -> NDArray[np.int64]:
    low, high = float(np.min(span)), float(np.max(span))
    return np.arange(max(int(np.ceil(low)), 0), min(int(np.floor(high)), size - 1) + 1, dtype=np.int64)
