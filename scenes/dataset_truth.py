"""truth.parquet: one row per (frame, sensor), made from the frame.json files."""

import io
from collections.abc import Iterator
from pathlib import Path

from scenes.dataset_frame import read_frame_json, truth_rows
from scenes.dataset_layout import TRUTH_COLUMNS
from scenes.dataset_manifest import Manifest

Row = dict[str, int | str | float]


def rows(dataset: Path, frames: range) -> Iterator[Row]:
    """The rows of the truth table as the frame.json files have them. Raises ``DatasetError``."""
    for frame in frames:
        body = read_frame_json(dataset, frame)
        for sensor, row in sorted(truth_rows(body).items()):
            yield {"frame": frame, "sensor": sensor, "time_s": float(body["time_s"]), **row}


def truth_table_bytes(dataset: Path, manifest: Manifest) -> bytes:
    """The bytes of truth.parquet: the same frames give the same bytes, for one version of pyarrow."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    all_rows = list(rows(dataset, manifest.selected))
    more = sorted({name for row in all_rows for name in row} - {"frame", "sensor", "time_s", *TRUTH_COLUMNS})
    numbers = ["time_s", *TRUTH_COLUMNS, *more]
    columns = {
        "frame": pa.array([row["frame"] for row in all_rows], pa.int64()),
        "sensor": pa.array([row["sensor"] for row in all_rows], pa.string()),
    } | {name: pa.array([row.get(name, float("nan")) for row in all_rows], pa.float64()) for name in numbers}
    buffer = io.BytesIO()
    pq.write_table(pa.table(columns), buffer, compression="zstd", version="2.6", store_schema=False)
    return buffer.getvalue()
