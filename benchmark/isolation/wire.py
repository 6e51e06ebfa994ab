"""How values cross from the judge's process to a method's: only those that a method may have, bit for bit, arrays uncopied.

A message is a list of parts: a pickle, then the arrays' bytes. What comes back is JSON, because whoever unpickles what a stranger
sent runs the stranger's code.
"""

import pickle
from collections.abc import Sequence
from dataclasses import is_dataclass
from io import BytesIO
from types import BuiltinFunctionType, FunctionType, MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.intrinsics import Intrinsics
from scenes.recording import (
    ChaserState,
    CornerPrior,
    Image,
    Knowledge,
    LidarModel,
    ModelCloud,
    Observation,
    Rectangle,
    Ring,
    Scan,
    SensorModel,
    StereoPair,
)

Bytes = NDArray[np.uint8]
_GIVEN = (
    *(Observation, Image, Scan, ChaserState),
    *(Knowledge, SensorModel, Intrinsics, LidarModel, CornerPrior, Rectangle, StereoPair, Ring, ModelCloud),
)
_NUMBERS = (np.ndarray, np.generic, np.dtype, Rotation)
_NAMES = (type, FunctionType, BuiltinFunctionType)  # what the above name to rebuild themselves, by reference


def pack(value: object) -> list[Bytes]:
    """The parts of a message. Raises ``TypeError`` where ``value`` holds anything that a method must not have."""
    buffers: list[pickle.PickleBuffer] = []
    stream = BytesIO()
    _Values(stream, protocol=5, buffer_callback=buffers.append).dump(value)
    return [np.frombuffer(one, dtype=np.uint8) for one in (stream.getbuffer(), *(buffer.raw() for buffer in buffers))]


def unpack(parts: Sequence[Bytes]) -> Any:
    """The value in the parts, whose arrays stay where the parts are."""
    return pickle.loads(parts[0].data, buffers=parts[1:])


class _Values(pickle.Pickler):
    def reducer_override(self, obj: Any) -> Any:
        """Called for whatever is neither a plain number or text nor a plain container of them."""
        if type(obj) is MappingProxyType:
            return _read_only, (dict(obj),)
        if type(obj) is RigidTransform:  # its own way normalises the rotation anew
            return _transform, (obj.as_matrix(),)
        if type(obj) in _GIVEN or isinstance(obj, (*_NUMBERS, *_NAMES)):
            return NotImplemented
        kind = "a value that no method is told of" if is_dataclass(obj) else "not a value"
        raise TypeError(f"{type(obj).__name__} is {kind}; it does not go to a method")


def _read_only(mapping: dict[str, Any]) -> MappingProxyType[str, Any]:
    return MappingProxyType(mapping)


def _transform(matrix: Any) -> RigidTransform:
    return RigidTransform(matrix, normalize=False)
