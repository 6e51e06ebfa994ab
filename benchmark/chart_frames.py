"""The pooled frames as charts need them: the errors that are drawn, without an answer infinite, and what may be compared."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from benchmark.chart_draws import Draws, draws_of
from benchmark.metrics import SPEED_POSITION, SPEED_ROTATION_RAD, WRONG_DEG
from benchmark.ranking_cells import some
from benchmark.ranking_table import divided
from benchmark.ring_scores import WRONG_OF_RANGE

MOST_DIVISIONS = 3


@dataclass(frozen=True, slots=True, eq=False)
class Quantity:
    """An error to draw: its column, what it is called, its unit, and the lines that mark the SPEED threshold and a wrong answer."""

    column: str
    title: str
    unit: str
    speed: float
    wrong: float

    @property
    def label(self) -> str:
        """For an axis."""
        return f"{self.title} ({self.unit})"


ROTATION = Quantity("rotation", "rotation error", "deg", float(np.degrees(SPEED_ROTATION_RAD)), WRONG_DEG)
POSITION = Quantity("position", "position error", "% of range", 100 * SPEED_POSITION, 100 * WRONG_OF_RANGE)


@dataclass(frozen=True, slots=True, eq=False)
class Division:
    """Tracks that the same methods were asked for, so that their numbers may be compared: a title and all their frames.

    The frames' column ``place`` says which frame of the ``draws`` a row is; rows of all methods on one frame have the same.
    """

    title: str
    frames: pd.DataFrame
    draws: Draws


def with_errors(frames: pd.DataFrame) -> pd.DataFrame:
    """``frames`` with ``rotation`` (deg) and ``position`` (% of the range): infinite without an answer, NaN where none is asked.

    An infinite error keeps a frame without an answer in every count and every median, as the ranking has it.
    """
    answered = frames["answered"].to_numpy(dtype=bool)
    errors = {
        ROTATION.column: frames["geodesic_deg"].to_numpy(dtype=np.float64),
        POSITION.column: 100 * frames["position_error_m"].to_numpy(dtype=np.float64) / frames["range_m"].to_numpy(dtype=np.float64),
    }
    return frames.assign(**{name: np.where(answered & np.isfinite(error), error, np.inf) for name, error in errors.items()})


def quantities(frames: pd.DataFrame) -> tuple[Quantity, ...]:
    """The errors that these frames have: a rectangle of unknown size has no position."""
    return tuple(one for one in (ROTATION, POSITION) if one is ROTATION or np.isfinite(frames[one.column]).any())


def divisions(frames: pd.DataFrame, most: int = MOST_DIVISIONS) -> tuple[tuple[Division, ...], int]:
    """The divisions with the most frames, the largest first, and how many more there are."""
    parts = sorted(divided(frames), key=len, reverse=True)
    whole = len(parts) == 1
    return tuple(_division("all cases" if whole else _cases(part), part) for part in parts[:most]), max(0, len(parts) - most)


def _division(title: str, frames: pd.DataFrame) -> Division:
    draws, places = draws_of(frames)
    return Division(title, frames.assign(place=places), draws)


def by_method(frames: pd.DataFrame, places: dict[str, int]) -> Iterator[tuple[str, int, pd.DataFrame]]:
    """(title, place, its frames) of each method that has some, in the order of the places."""
    parts = dict(list(frames.groupby("method", sort=False)))
    return ((title, place, parts[title]) for title, place in places.items() if title in parts)


def _cases(frames: pd.DataFrame) -> str:
    return some(list(dict.fromkeys(frames["case"])))
