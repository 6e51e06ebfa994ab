"""Where a LIDAR's beams point and when they are fired. LIDAR axes are a camera's: x right, y down, z forward."""

import math
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from scenes.arrays import Floats, frozen, unit
from scenes.spec import NonNegative, Positive, Spec

Count = Annotated[int, Field(ge=1, le=4096)]
FlashField = Annotated[float, Field(gt=0, lt=150)]
RasterField = Annotated[float, Field(ge=0, lt=170)]
MOST_BEAMS = 2**22


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """All beams of a scan in the order of its file.

    ``directions_lidar`` (rows, columns, 3): unit vectors. ``time_s`` (rows, columns): when each is fired, counted from the
    middle of the scan. ``pulses``: how many pulses the scan takes (one for a flash, else one a beam).
    """

    directions_lidar: Floats
    time_s: Floats
    pulses: int


class Flash(Spec):
    """One pulse lights the whole field, and a focal plane of ``columns`` × ``rows`` pixels times what comes back.

    ``field_deg``: full angles, horizontal and vertical, between the outer edges of the outermost pixels. As behind a lens, equal
    pixels are equal steps of the tangent.
    """

    type: Literal["flash"]
    columns: Count
    rows: Count
    field_deg: tuple[FlashField, FlashField]

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns) of a scan."""
        return self.rows, self.columns

    @property
    def duration_s(self) -> float:
        """From the first beam to the last."""
        return 0.0

    @property
    def beams(self) -> Beams:
        """The pixels' centres, all at once."""
        x, y = (_centres(n) * math.tan(math.radians(deg) / 2) for n, deg in zip((self.columns, self.rows), self.field_deg))
        across, down = np.meshgrid(x, y)
        return Beams(frozen(unit(np.stack([across, down, np.ones_like(across)], axis=-1))), frozen(np.zeros(self.shape)), 1)


class Raster(Spec):
    """A mirror sweeps one beam along rows, from the top row to the bottom one; the beams are evenly spaced in time and angle.

    ``field_deg``: full angles between the outermost beams, horizontal and vertical. ``scan_s``: from the first beam to the last.
    ``bidirectional``: every other row is swept from right to left.
    """

    type: Literal["raster"]
    columns: Count
    rows: Count
    field_deg: tuple[RasterField, RasterField]
    scan_s: Positive
    bidirectional: bool = False

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns) of a scan: by place, whatever the direction of the sweep."""
        return self.rows, self.columns

    @property
    def duration_s(self) -> float:
        """From the first beam to the last."""
        return self.scan_s

    @property
    def beams(self) -> Beams:
        """Azimuth along the columns, elevation down the rows."""
        azimuth, elevation = (_ends(n) * math.radians(deg) / 2 for n, deg in zip((self.columns, self.rows), self.field_deg))
        across, down = np.meshgrid(azimuth, elevation)
        directions = np.stack([np.sin(across) * np.cos(down), np.sin(down), np.cos(across) * np.cos(down)], axis=-1)
        order = np.arange(self.rows * self.columns, dtype=np.float64).reshape(self.shape)
        if self.bidirectional:
            order[1::2] = order[1::2, ::-1]
        return Beams(frozen(directions), frozen(_spread(order, self.scan_s)), order.size)


class Rosette(Spec):
    """Two wedge prisms that turn at different rates bend one beam to and fro: a rosette. A scan is one row of ``beams``.

    ``deflection_deg``: by how much each prism bends the beam (thin prisms: the two bends add as vectors). ``turns_hz``: how fast
    each turns, negative for the other way round. ``scan_s``: from the first beam to the last; every scan begins alike.
    """

    type: Literal["rosette"]
    beams_per_scan: Annotated[int, Field(ge=1, le=MOST_BEAMS)]
    deflection_deg: tuple[Annotated[float, Field(gt=0, lt=40)], Annotated[float, Field(gt=0, lt=40)]]
    turns_hz: tuple[float, float]
    scan_s: Positive

    @model_validator(mode="after")
    def _turns(self) -> "Rosette":
        if self.turns_hz[0] == self.turns_hz[1]:
            raise ValueError(f"turns_hz {self.turns_hz}: prisms that turn alike draw a circle, not a rosette")
        return self

    @property
    def shape(self) -> tuple[int, int]:
        """(1, beams) of a scan."""
        return 1, self.beams_per_scan

    @property
    def duration_s(self) -> float:
        """From the first beam to the last."""
        return self.scan_s

    @property
    def beams(self) -> Beams:
        """The bent beams in the order in which they are fired."""
        time_s = _spread(np.arange(self.beams_per_scan, dtype=np.float64), self.scan_s)
        bent = np.zeros((self.beams_per_scan, 2))
        for deflection, rate in zip(self.deflection_deg, self.turns_hz):
            phase = 2 * np.pi * rate * (time_s + self.scan_s / 2)
            bent += math.radians(deflection) * np.stack([np.cos(phase), np.sin(phase)], axis=-1)
        off = np.linalg.norm(bent, axis=-1, keepdims=True)
        directions = np.concatenate([np.sinc(off / np.pi) * bent, np.cos(off)], axis=-1)
        return Beams(frozen(directions[None]), frozen(time_s[None]), self.beams_per_scan)


ScanPattern = Annotated[Flash | Raster | Rosette, Field(discriminator="type")]


def half_field_rad(pattern: Flash | Raster | Rosette) -> float:
    """The largest angle of a beam from the axis."""
    return float(np.arccos(np.clip(pattern.beams.directions_lidar[..., 2].min(), -1, 1)))


def _centres(count: int) -> Floats:
    """The middles of ``count`` equal cells of −1 … 1."""
    return np.asarray((2 * np.arange(count) + 1) / count - 1)


def _ends(count: int) -> Floats:
    """``count`` points from −1 to 1, the middle where there is one only."""
    return np.linspace(-1, 1, count) if count > 1 else np.zeros(1)


def _spread(order: Floats, scan_s: NonNegative) -> Floats:
    """Instants of beams by their place in the firing order, about 0."""
    last = max(order.size - 1, 1)
    return np.asarray((order / last - 0.5) * scan_s) if order.size > 1 else np.zeros_like(order)
