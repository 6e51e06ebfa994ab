"""What ``hardlight bound`` does: the Cramér-Rao bound of every frame, and how near answers come to it."""

from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING

from benchmark.console import Console

if TYPE_CHECKING:
    import pandas as pd

    from scenes.dataset import Dataset


def bound(path: Path, out: Path, frames: str | None, answers: Path | None, console: Console) -> None:
    """Writes bounds.parquet and prints its medians per sensor; with ``answers`` also their efficiency."""
    from benchmark.information import table as bounds
    from scenes.dataset import Dataset
    from scenes.dataset_range import parse_frames

    dataset = Dataset.open(path)
    chosen = dataset.frames if frames is None else [dataset.frames[at] for at in parse_frames(frames, len(dataset.frames))]
    with console.stage(f"bound {len(chosen)} frames") as progress:
        table = bounds.bounds_table(dataset, chosen, progress)
    bounds.write(out, table)
    rows = []
    for sensor, mine in table.groupby("sensor"):
        known = mine["sigma_rotation_rad"].notna()
        middle = mine[known].median(numeric_only=True)
        figures = {"σ attitude mdeg": "—", "σ position mm": "—"}
        if known.any():
            figures = {
                "σ attitude mdeg": f"{1e3 * degrees(middle['sigma_rotation_rad']):.2f}",
                "σ position mm": f"{1e3 * middle['sigma_position_m']:.3f}",
            }
        rows.append({"sensor": str(sensor), "frames": str(len(mine)), "undetermined": str(int((~known).sum())), **figures})
    console.table("the bound: medians over the frames", rows)
    if answers is not None:
        _say_achieved(answers, dataset, table, console)
    console.say(f"{out / bounds.BOUNDS}: {len(table)} rows")


def _say_achieved(answers: Path, dataset: "Dataset", table: "pd.DataFrame", console: Console) -> None:
    from benchmark import judge, predictions
    from benchmark.information.achieved import FEWEST, achieved

    given = predictions.read(answers)
    judge.refuse_strangers(given, dataset)
    lines = achieved(given, dataset, table)
    rows = [
        {
            "sensor": one.sensor,
            "answered": str(one.frames),
            "efficiency, pose": "—" if one.pose is None else f"{one.pose:.2g}",
            "efficiency, attitude": "—" if one.attitude is None else f"{one.attitude:.2g}",
            "error over σ": f"{one.excess:.3g}",
        }
        for one in lines
    ]
    console.table(f"{given.record.title}: 1 is an ideal estimator, — fewer than {FEWEST} frames or no position", rows)
