"""Small rotations on the device."""

from typing import Any


def turned(mi: Any, dr: Any, vector: Any, rotation_vector: Any) -> Any:
    """exp(rotation vector) · vector by its series: eight terms leave 1e-7 relative at the half radian that is allowed."""
    turned, term = mi.Vector3f(vector), mi.Vector3f(vector)
    for order in range(1, 8):
        term = dr.cross(rotation_vector, term) / order
        turned += term
    return turned
