"""What ``hardlight bound`` does: the Cramér-Rao bound of every frame, and how near answers come to it."""

from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING

from benchmark.console import Console

if TYPE_CHECKING:
    import pandas as pd

    from scenes.dataset import Dataset


def bound(
    path: Path, out: Path | None, frames: str | None, answers: Path | None, light_direction: bool, console: Console
) -> None:
    """Completes bounds.parquet, the data set's own where ``out`` is left out, and prints its medians per sensor.

    With ``answers`` it also prints their efficiency.
    """
    from benchmark.information import SAMPLES, kept
    from benchmark.information.table import sensors_of
    from scenes.dataset import Dataset
    from scenes.dataset_range import parse_frames

    dataset, folder = Dataset.open(path), path if out is None else out
    chosen = dataset.frames if frames is None else [dataset.frames[at] for at in parse_frames(frames, len(dataset.frames))]
    with console.stage(f"bound {len(chosen)} frames") as progress:
        table = kept.completed(
            dataset, folder, chosen, sensors_of(dataset), progress, samples=SAMPLES, light_direction=light_direction
        )
    console.table("the bound: medians over the frames", [_cells(str(sensor), mine) for sensor, mine in table.groupby("sensor")])
    if answers is not None:
        _say_achieved(answers, dataset, table, console)
    console.say(f"{folder / kept.BOUNDS}: {len(table)} rows")


def _cells(sensor: str, mine: "pd.DataFrame") -> dict[str, str]:
    """One sensor's line: σ of attitude and position where they are determined."""
    known = mine["sigma_rotation_rad"].notna()
    line = {"sensor": sensor, "frames": str(len(mine)), "undetermined": str(int((~known).sum()))}
    if not known.any():
        return line | {"σ attitude mdeg": "—", "σ position mm": "—"}
    middle = mine[known].median(numeric_only=True)
    return line | {
        "σ attitude mdeg": f"{1e3 * degrees(middle['sigma_rotation_rad']):.2f}",
        "σ position mm": f"{1e3 * middle['sigma_position_m']:.3f}",
    }


def _say_achieved(answers: Path, dataset: "Dataset", table: "pd.DataFrame", console: Console) -> None:
    from benchmark import judge, predictions
    from benchmark.information.achieved import achieved
    from benchmark.information.fisher import FEWEST

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
