"""bounds.parquet: bounds that are kept, in their data set's own folder or elsewhere; what is there is not found again."""

from collections.abc import Sequence
from pathlib import Path
from time import monotonic
from typing import Any

import pandas as pd

from benchmark.errors import PredictionsError
from benchmark.files import publish
from benchmark.progress import Progress
from scenes.dataset import Dataset
from scenes.errors import DatasetError
from scenes.provenance import software_versions

BOUNDS = "bounds.parquet"
_DATASET, _HOW = "dataset_identity", "how"
_OFTEN_S = 20.0  # between two times of keeping what was found: that much is lost where it is killed

Rows = dict[tuple[int, str], dict[str, Any]]


def read(dataset: Dataset) -> pd.DataFrame | None:
    """The bounds in the data set's folder, rows of ``table.bounds_table`` of some of its frames and sensors; None without any.

    They join the truth table on frame and sensor. Raises ``PredictionsError`` where they are another data set's, or damaged.
    """
    path = dataset.path / BOUNDS
    if not path.is_file():
        return None
    found = _opened(path)
    if found.attrs.get(_DATASET) != dataset.identity:
        raise PredictionsError(f"{path} is not of this data set ({dataset.identity}); remove it, or run hardlight bound again")
    return found


def faults(path: Path) -> list[str]:
    """What is wrong with the bounds in the folder of a data set, which may be broken itself; nothing where there are none."""
    try:
        read(Dataset.open(path))
    except PredictionsError as error:
        return [str(error)]
    except DatasetError:
        return []
    return []


def completed(
    dataset: Dataset,
    folder: Path,
    frames: Sequence[int],
    sensors: Sequence[str],
    progress: Progress | None = None,
    *,
    samples: int,
    light_direction: bool = False,
    name: str = BOUNDS,
    alone: bool = False,
) -> pd.DataFrame:
    """The rows of ``frames`` and ``sensors``; those that the file ``name`` in ``folder`` lacks are found and kept as it goes on.

    What it holds of another data set, or found in another way or by another version, is replaced; ``alone``: so is what it holds of
    other frames and sensors.
    """
    from benchmark.information.table import frame_rows

    how: dict[str, Any] = {"samples": samples, "light_direction": light_direction}
    attrs = {_DATASET: dataset.identity, _HOW: how | {"software": software_versions()}}
    there, kept, asked = _there(folder / name, attrs), monotonic(), {(frame, sensor) for frame in frames for sensor in sensors}
    rows = {key: row for key, row in there.items() if not alone or key in asked}
    lacking = [frame for frame in frames if any((frame, sensor) not in rows for sensor in sensors)]
    for found in frame_rows(dataset, lacking, sensors, progress, **how) if lacking else ():
        rows |= {(row["frame"], row["sensor"]): row for row in found}
        if monotonic() - kept > _OFTEN_S:
            _keep(folder, name, rows, attrs)
            kept = monotonic()
    if lacking or len(rows) < len(there):
        _keep(folder, name, rows, attrs)
    return pd.DataFrame([rows[frame, sensor] for frame in frames for sensor in sensors])


def _there(path: Path, attrs: dict[str, Any]) -> Rows:
    """The kept rows by frame and sensor, none where they are not what ``attrs`` says."""
    if not path.is_file() or (found := _opened(path)).attrs != attrs:
        return {}
    records = ({str(name): value for name, value in row.items()} for row in found.to_dict("records"))
    return {(one["frame"], one["sensor"]): one for one in records}


def _opened(path: Path) -> pd.DataFrame:
    try:
        return pd.read_parquet(path)
    except (OSError, ValueError) as error:
        raise PredictionsError(f"{path} is damaged ({error}); remove it, then hardlight bound writes it anew") from None


def _keep(folder: Path, name: str, rows: Rows, attrs: dict[str, Any]) -> None:
    table = pd.DataFrame([rows[key] for key in sorted(rows)])
    table.attrs = dict(attrs.items())
    publish(folder, {name: table.to_parquet(index=False)})
