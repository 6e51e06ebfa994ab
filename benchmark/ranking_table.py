"""The frames of one division side by side: of every quantity a table with a row per frame and a column per method."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pandas as pd

from benchmark.errors import PredictionsError
from benchmark.pool import TRACK
from benchmark.ranking_bootstrap import SHORTEST, Track, block_length
from benchmark.ranking_efficiency import squares
from benchmark.ranking_rule import charges, unanswered
from benchmark.subjects import Modality
from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """``values``: (frames, methods) of each quantity, track by track as ``tracks`` tells, those too short for blocks last.

    ``charge``, ``answered``, ``wrong``, ``timed`` (1 or 0), ``cpu_ms`` (0 where not timed), and the errors ``rotation_deg``,
    ``position_m``, ``position_share`` (of the range) and ``bound_squares`` (``ranking_efficiency``), infinite where there is none.
    """

    modality: Modality
    methods: tuple[str, ...]
    tracks: tuple[Track, ...]
    values: Mapping[str, Floats]

    @property
    def frames(self) -> int:
        """How many there are, of all tracks."""
        return sum(track.frames for track in self.tracks)


def table_of(frames: pd.DataFrame) -> Table:
    """Arranges rows of ``benchmark.pool.pool`` of one modality; their order makes no difference.

    A frame that a method says nothing of is one without an answer. Raises ``PredictionsError`` where it says two things.
    """
    modality: Modality = frames["modality"].iloc[0]
    lacking = dict.fromkeys(("rotation_deg", "position_m", "position_share", "bound_squares"), np.inf)
    absent = {"charge": unanswered(modality), **lacking}
    quantities = _quantities(frames)
    keys = [*TRACK, "frame", "method"]
    long = frames[keys].assign(**quantities).set_index(keys)
    twice = long.index[long.index.duplicated()]
    if len(twice):
        run, subject, sensor, frame, method = twice[0]
        raise PredictionsError(f"two entries are called {method!r} and answer frame {frame} of {run}, {subject}, {sensor}")
    wide = long.unstack("method").sort_index()
    sizes = wide.groupby(level=TRACK).size()
    short_last = np.argsort(np.repeat(sizes.to_numpy(), sizes.to_numpy()) < SHORTEST, kind="stable")
    runs = sizes.index.get_level_values("run").astype(str)
    tracks = _tracks(list(runs), list(sizes), wide["charge"].fillna(absent["charge"]).to_numpy(np.float64))
    return Table(
        modality=modality,
        methods=tuple(str(name) for name in wide["charge"].columns),
        tracks=tuple(sorted(tracks, key=lambda track: track.frames < SHORTEST)),
        values={name: wide[name].fillna(absent.get(name, 0.0)).to_numpy(np.float64)[short_last] for name in quantities},
    )


def divided(frames: pd.DataFrame) -> list[pd.DataFrame]:
    """Rows of ``benchmark.pool.pool`` by division: all tracks of a modality that the same set of methods answered, in order."""
    if frames.empty:
        return []
    track = ["modality", *TRACK]
    answering = frames[[*track, "method"]].drop_duplicates().groupby(track)["method"].agg(lambda names: repr(sorted(names)))
    named = frames.join(answering.rename("_methods"), on=track)
    return [part.drop(columns="_methods") for _, part in named.groupby(["modality", "_methods"], sort=False)]


def _tracks(runs: list[str], sizes: list[int], charge: Floats) -> list[Track]:
    """The tracks, with blocks that are long enough for the mean charge of each method and the difference of each pair."""
    pairs = list(combinations(range(charge.shape[1]), 2))
    series = np.hstack([charge, charge[:, [one for one, _ in pairs]] - charge[:, [other for _, other in pairs]]])
    parts = np.split(series, np.cumsum(sizes)[:-1])
    wanted = [block_length(part) for part in parts]
    longest: dict[tuple[str, int], int] = {}
    for run, size, length in zip(runs, sizes, wanted, strict=True):
        longest[run, size] = max(length, longest.get((run, size), 0))
    return [Track(run, size, longest[run, size]) for run, size in zip(runs, sizes, strict=True)]


def _quantities(frames: pd.DataFrame) -> dict[str, Floats]:
    """Of each row what ``Table`` is made of."""
    answered = frames["answered"].to_numpy(dtype=bool)
    cpu_s = frames["cpu_s"].to_numpy(dtype=np.float64)
    position_m = frames["position_error_m"].to_numpy(dtype=np.float64)
    errors = {
        "rotation_deg": frames["geodesic_deg"].to_numpy(dtype=np.float64),
        "position_m": position_m,
        "position_share": position_m / frames["range_m"].to_numpy(dtype=np.float64),
    }
    return {
        "charge": charges(frames),
        "bound_squares": squares(frames),
        "answered": answered.astype(np.float64),
        "wrong": frames["wrong"].to_numpy(dtype=np.float64),
        "timed": np.isfinite(cpu_s).astype(np.float64),
        "cpu_ms": 1e3 * np.nan_to_num(cpu_s),
        **{name: np.where(answered & ~np.isnan(error), error, np.inf) for name, error in errors.items()},
    }
