"""A scan as a PCD file, as PCL, ROS and Open3D read it: organised, PCD 0.7, fields x y z intensity t, NaN without a return."""

import io
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from scenes.recording import Scan

_FIELDS: Sequence[str] = ("x", "y", "z", "intensity", "t")
_NAN = np.uint32(0x7FC00000)


def encode_scan(scan: Scan) -> bytes:
    """The bytes of a scan, compressed: the same scan gives the same bytes. Width is its columns, height its rows."""
    from pypcd4 import Encoding, PointCloud

    rows, columns = scan.intensity.shape
    points = scan.points_lidar.reshape(-1, 3)
    values = (*points.T, scan.intensity.ravel(), scan.time_s.ravel())
    cloud = PointCloud.from_points([_one_nan(column) for column in values], _FIELDS, (np.float32,) * len(_FIELDS))
    cloud.metadata = cloud.metadata.derive(width=columns, height=rows)
    buffer = io.BytesIO()
    cloud.save(buffer, encoding=Encoding.BINARY_COMPRESSED)
    return buffer.getvalue()


def decode_scan(data: bytes) -> Scan:
    """A scan back from its bytes. Raises ``ValueError`` on a file that is broken or has other fields."""
    from pypcd4 import PointCloud

    try:
        cloud = PointCloud.from_fileobj(io.BytesIO(data))
        columns = [np.ascontiguousarray(cloud.pc_data[name], np.float32) for name in _FIELDS]
        shape = (cloud.metadata.height, cloud.metadata.width)
        x, y, z, intensity, time_s = (column.reshape(shape) for column in columns)
    except Exception as error:  # a parser of foreign files fails in any way there is
        raise ValueError(f"not a readable scan ({type(error).__name__}: {error})") from error
    arrays = (np.stack([x, y, z], axis=-1), intensity, time_s)
    for array in arrays:
        array.flags.writeable = False
    return Scan(*arrays)


def _one_nan(column: NDArray[np.float32]) -> NDArray[np.float32]:
    """The column as float32 in which every NaN has the same bits."""
    values = np.array(column, dtype=np.float32)
    values.view(np.uint32)[np.isnan(values)] = _NAN
    return values
