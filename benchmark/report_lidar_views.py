"""What the page shows of a LIDAR case: its methods over all seeds beside the paper's figures, plots and scans of the first seed."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmark import predictions
from benchmark.filter_nees import DIMENSION, mean_bounds
from benchmark.filter_seeds import SeedsLine, seeds_lines
from benchmark.filter_states import STATES
from benchmark.filter_summary import state_errors
from benchmark.judge import SCORES
from benchmark.leaderboard import Row
from benchmark.predictions import Predictions
from benchmark.report_lidar_pictures import ScanStrip, scan_strip
from benchmark.report_lidar_plots import Line, StateTrack, honesty_plot, registration_plot, state_plot
from benchmark.report_lidar_printed import PrintedFilterView, printed_filter_view
from benchmark.report_ring_views import reason
from benchmark.results import Results
from scenes.arrays import Floats
from scenes.dataset import Dataset
from scenes.solids import solids
from scenes.target import Target

_FAILURES_SHOWN = 3


@dataclass(frozen=True, slots=True, eq=False)
class LidarEntryView:
    """One method: its line over all seeds, and of the first seed the answers, the plot and why frames have no answer."""

    line: SeedsLine
    series: int
    answers: Predictions
    plot: str
    failures: tuple[str, ...]

    @property
    def row(self) -> Row:
        """The row of the first seed, as other entries have one."""
        return self.line.rows[0]


@dataclass(frozen=True, slots=True, eq=False)
class LidarView:
    """Everything about one LIDAR of one case."""

    name: str
    seeds: tuple[int, ...]
    entries: tuple[LidarEntryView, ...]
    printed: tuple[PrintedFilterView, ...]
    honesty: str
    registration: str
    strips: tuple[ScanStrip, ...]


def lidar_views(folder: Path, index: Results, case: str, rows: Sequence[Row], titles: Sequence[str]) -> tuple[LidarView, ...]:
    """A view for each LIDAR of the ``rows`` of one case, all its seeds; a method's place in ``titles`` is its colour."""
    sensors = dict.fromkeys(row.summary.sensor for row in rows)
    return tuple(_view(folder, index, case, [row for row in rows if row.summary.sensor == one], titles) for one in sensors)


def _view(folder: Path, index: Results, case: str, rows: Sequence[Row], titles: Sequence[str]) -> LidarView:
    sensor, lines = rows[0].summary.sensor, seeds_lines(rows, index.bases)
    tables = {line.title: [_scores(folder, row) for row in line.rows] for line in lines}
    first = Dataset.open(folder / rows[0].entry.dataset)
    entries = tuple(_entry(folder, line, tables[line.title][0], titles.index(line.title), case) for line in lines)
    series = {line.title: titles.index(line.title) for line in lines}
    runs = max(len(line.rows) for line in lines)
    return LidarView(
        name=sensor,
        seeds=_seeds(index, rows),
        entries=entries,
        printed=tuple(printed_filter_view(one, lines) for one in index.published_filters if one.case == case),
        honesty=_honesty(tables, series, runs, f"{case}-{sensor}"),
        registration=_registration(tables, series, f"{case}-{sensor}"),
        strips=tuple(_strips(first, sensor, tables[lines[0].title][0])),
    )


def _entry(folder: Path, line: SeedsLine, scores: pd.DataFrame, series: int, case: str) -> LidarEntryView:
    answers, title = predictions.read(folder / line.rows[0].entry.answers), line.title
    label = f"{title} on {case}: error of each state against time within three standard deviations"
    plot = state_plot(_track(scores, series), f"states-{case}-{title}", label) if (scores["outcome"] == "ok").any() else ""
    failed = scores[scores["outcome"] != "ok"]
    told = {f"{score['outcome']}{reason(score, answers)}": int(score["frame"]) for _, score in failed.iloc[::-1].iterrows()}
    failures = tuple(f"frame {frame}: {text}" for text, frame in list(told.items())[::-1][:_FAILURES_SHOWN])
    return LidarEntryView(line, series, answers, plot, failures)


def _track(scores: pd.DataFrame, series: int) -> StateTrack:
    return StateTrack(
        series=series,
        time_s=scores["time_s"].to_numpy(dtype=np.float64),
        errors={state.key: state_errors(state, scores) for state in STATES},
        sigmas={
            state.key: state.scale * scores[list(state.sigmas)].to_numpy(dtype=np.float64) if state.sigmas else None
            for state in STATES
        },
        inertia_error=scores["inertia_error"].to_numpy(dtype=np.float64),
    )


def _honesty(tables: dict[str, list[pd.DataFrame]], series: dict[str, int], runs: int, salt: str) -> str:
    """The mean over the seeds; empty where no method states a covariance."""
    lines = []
    for title, seeds in tables.items():
        values = np.stack([scores["nees"].to_numpy(dtype=np.float64) for scores in seeds])
        there = np.isfinite(values).any(axis=0)
        if there.any():
            lines.append(Line(series[title], _time(seeds[0])[there], np.nanmean(values[:, there], axis=0)))
    label = f"NEES of {len(lines)} methods against time, mean over {runs} seeds, with the bounds of 95 % of honest means"
    return honesty_plot(lines, mean_bounds(DIMENSION, runs), f"nees-{salt}", label) if lines else ""


def _registration(tables: dict[str, list[pd.DataFrame]], series: dict[str, int], salt: str) -> str:
    """Of the first seed; empty where no method gives its registration."""
    lines: dict[str, list[Line]] = {name: [] for name in ("icp_attitude_error_deg", "icp_position_error_m")}
    for title, seeds in tables.items():
        for name, chosen in lines.items():
            values = seeds[0][name].to_numpy(dtype=np.float64)
            if np.isfinite(values).any():
                chosen.append(Line(series[title], _time(seeds[0]), values))
    attitude, position = lines.values()
    label = "error of each scan's registration against time, attitude above, position below"
    return registration_plot(attitude, position, f"icp-{salt}", label) if attitude else ""


def _strips(dataset: Dataset, lidar: str, scores: pd.DataFrame) -> Iterator[ScanStrip]:
    """The first scan, the middle one and the last."""
    frames, shape = scores["frame"].to_list(), solids(Target.model_validate(dataset.scenario["target"]))
    table = dataset.truth_table()
    counted = table[table["sensor"] == lidar].set_index("frame")
    for frame in sorted({frames[0], frames[len(frames) // 2], frames[-1]}):
        row = counted.loc[frame]
        caption = f"frame {frame}, {row['time_s']:g} s, {row['range_m']:.1f} m: {row['returns']:.0f} returns"
        yield scan_strip(dataset, lidar, frame, shape, caption)


def _seeds(index: Results, rows: Sequence[Row]) -> tuple[int, ...]:
    known = {case.name: case.seed for case in index.cases}
    seeds = (known.get(name) for name in dict.fromkeys(row.entry.case for row in rows))
    return tuple(seed for seed in seeds if seed is not None)


def _scores(folder: Path, row: Row) -> pd.DataFrame:
    scores = pd.read_parquet(folder / row.entry.scores / SCORES)
    return scores[scores["sensor"] == row.summary.sensor]


def _time(scores: pd.DataFrame) -> Floats:
    return scores["time_s"].to_numpy(dtype=np.float64)
