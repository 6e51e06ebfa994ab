"""Quaternions as a person writes them: scalar first, of length one but for rounding."""

import math
from typing import Annotated

from pydantic import AfterValidator, BaseModel
from scipy.spatial.transform import Rotation

ROUNDING = 1e-3  # papers print three or four digits


def _nearly_unit(wxyz: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    length = math.hypot(*wxyz)
    if abs(length - 1) > ROUNDING:
        raise ValueError(f"the quaternion {list(wxyz)} has length {length:.6g}, must be 1 within {ROUNDING:g}")
    return wxyz


# The numbers stay as they were written; whoever uses them normalises by way of ``rotation``.
Quaternion = Annotated[tuple[float, float, float, float], AfterValidator(_nearly_unit)]


def rotation(wxyz: tuple[float, float, float, float]) -> Rotation:
    """The rotation of a quaternion (w, x, y, z) of any length but zero."""
    return Rotation.from_quat(wxyz, scalar_first=True)


def quaternion_notes(spec: BaseModel, path: str = "") -> list[str]:
    """One sentence for each quaternion of ``spec`` and the specs in it that is not of length one to six digits.

    They are the fields whose name ends in ``_wxyz``. ``path``: what the sentences put before the field's own name.
    """
    notes = []
    for name in type(spec).model_fields:
        value, where = getattr(spec, name), f"{path}.{name}" if path else name
        if name.endswith("_wxyz") and value is not None:
            length = math.hypot(*value)
            notes += [f"{where}: the quaternion has length {length:.6g}, it is normalised"] if abs(length - 1) > 1e-6 else []
        else:
            notes += [note for key, one in _specs(value) for note in quaternion_notes(one, where + key)]
    return notes


def _specs(value: object) -> list[tuple[str, BaseModel]]:
    """The specs that a field holds, each with what its key adds to the path."""
    if isinstance(value, BaseModel):
        return [("", value)]
    if isinstance(value, dict):
        return [(f".{key}", one) for key, one in value.items() if isinstance(one, BaseModel)]
    if isinstance(value, tuple):
        return [(f".{place}", one) for place, one in enumerate(value) if isinstance(one, BaseModel)]
    return []
