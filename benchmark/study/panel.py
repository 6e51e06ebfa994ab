"""A study's frames side by side: of every quantity a table with a row per frame, a column per point and one per method."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import get_args

import numpy as np
import pandas as pd

from benchmark.errors import PredictionsError
from benchmark.ranking_bootstrap import SHORTEST, Track, block_length
from benchmark.ranking_rule import unanswered
from benchmark.subjects import Modality
from scenes.arrays import Bools, Floats

_TRACK = ["seed", "subject", "sensor"]
_UNIT = [*_TRACK, "frame"]


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """All frames of one modality. A *unit* is what was the same at every point: a seed's frame of a subject, seen by a sensor.

    ``charge``, ``right`` (1 or 0) and ``rotation_deg`` (NaN where not right) are (units, points, methods), ``bound_rad`` (NaN where
    undetermined or not asked for) and ``bound_asked`` (units, points). Units lie track by track as ``tracks`` tells, those too
    short for blocks last. ``points`` are names, each there once, though a design may hold it several times.
    """

    modality: Modality
    methods: tuple[str, ...]
    points: tuple[str, ...]
    tracks: tuple[Track, ...]
    charge: Floats
    right: Floats
    rotation_deg: Floats
    bound_rad: Floats
    bound_asked: Bools

    @property
    def units(self) -> int:
        """How many there are, of all tracks."""
        return len(self.charge)

    @property
    def column(self) -> Mapping[str, int]:
        """Where a point is, by its name."""
        return {name: place for place, name in enumerate(self.points)}


def panels(frames: pd.DataFrame) -> tuple[Panel, ...]:
    """The frames of ``benchmark.study.outcomes.Outcomes``, in any order, by modality."""
    return tuple(_panel(modality, part) for modality in get_args(Modality) if len(part := frames[frames["modality"] == modality]))


def _panel(modality: Modality, frames: pd.DataFrame) -> Panel:
    """A frame that a method says nothing of is one without an answer."""
    points, methods = (sorted(frames[key].unique()) for key in ("point", "method"))
    long = _long(frames)
    quantities = long.set_index([*_UNIT, "point", "method"])[["charge", "right", "rotation_deg"]]
    wide = pd.DataFrame(quantities.unstack(["point", "method"])).sort_index()
    sizes = wide.groupby(level=_TRACK).size()
    charge, right, rotation_deg = (
        wide.reindex(columns=pd.MultiIndex.from_product([[name], points, methods])).fillna(absent).to_numpy(np.float64)
        for name, absent in (("charge", unanswered(modality)), ("right", 0.0), ("rotation_deg", np.nan))
    )
    bound_rad, asked = _bounds(long, wide.index, points)
    short_last = np.argsort(np.repeat(sizes.to_numpy(), sizes.to_numpy()) < SHORTEST, kind="stable")
    shape = (len(wide), len(points), len(methods))
    return Panel(
        modality=modality,
        methods=tuple(methods),
        points=tuple(points),
        tracks=_tracks(sizes, charge),
        charge=charge[short_last].reshape(shape),
        right=right[short_last].reshape(shape),
        rotation_deg=rotation_deg[short_last].reshape(shape),
        bound_rad=bound_rad[short_last],
        bound_asked=asked[short_last],
    )


def _long(frames: pd.DataFrame) -> pd.DataFrame:
    """``frames`` as numbers. Raises ``PredictionsError`` where a method says two things of one."""
    keys = [*_UNIT, "point", "method"]
    right = frames["right"].to_numpy(dtype=bool)
    long = frames.assign(
        seed=frames["seed"].astype(np.float64).fillna(-1.0),
        right=right.astype(np.float64),
        rotation_deg=np.where(right, frames["geodesic_deg"].to_numpy(dtype=np.float64), np.nan),
    )
    twice = long[long.duplicated(keys)]
    if len(twice):
        point, method, frame = twice.iloc[0][["point", "method", "frame"]]
        raise PredictionsError(f"two entries are called {method!r} and answer frame {frame} of {point}")
    return long


def _bounds(long: pd.DataFrame, units: pd.Index, points: list[str]) -> tuple[Floats, Bools]:
    """(units, points) each: the bound, NaN where there is none, and whether it was asked for. It is the same for all methods."""
    known = long.assign(
        bound=long["bound_rotation_rad"].where(long["bound_determined"].astype(bool)), asked=long["bound_asked"].astype(np.float64)
    )
    of_units = pd.DataFrame(known.groupby([*_UNIT, "point"])[["bound", "asked"]].max().unstack("point")).reindex(units)
    bound, asked = (
        of_units.reindex(columns=pd.MultiIndex.from_product([[name], points])).to_numpy(np.float64) for name in ("bound", "asked")
    )
    return bound, np.nan_to_num(asked) > 0


def _tracks(sizes: pd.Series, charge: Floats) -> tuple[Track, ...]:
    """The tracks, in blocks long enough for each method's charge at each point; tracks of one seed draw the same frames."""
    parts = np.split(charge, np.cumsum(sizes.to_numpy())[:-1])
    runs = [f"seed {seed:g}" for seed in sizes.index.get_level_values("seed")]
    longest: dict[tuple[str, int], int] = {}
    for run, part in zip(runs, parts, strict=True):
        longest[run, len(part)] = max(block_length(part), longest.get((run, len(part)), 0))
    tracks = [Track(run, len(part), longest[run, len(part)]) for run, part in zip(runs, parts, strict=True)]
    return tuple(sorted(tracks, key=lambda track: track.frames < SHORTEST))
