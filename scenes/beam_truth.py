"""What only the simulation knows of a scan, as a NumPy archive."""

import io
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


def encode_beams(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """The bytes of a compressed ``.npz``: the same arrays give the same bytes, as NumPy dates its entries 1980-01-01."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **{name: arrays[name] for name in sorted(arrays)})
    return buffer.getvalue()


def decode_beams(data: bytes) -> dict[str, NDArray[Any]]:
    """The arrays back. Raises ``ValueError`` on a broken file."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise ValueError(f"not a readable archive of arrays ({error})") from error
