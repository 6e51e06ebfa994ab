"""The base of everything a person writes: frozen, strict about keys, silent about nothing."""

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
Fraction = Annotated[float, Field(ge=0, le=1)]
Vector3 = tuple[float, float, float]


class Spec(BaseModel):
    """A frozen description that forbids unknown keys, NaN and infinity."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=False, validate_default=True)


def is_empty(value: object) -> bool:
    """Whether a field is left at None or without entries; such fields stay out of a resolved scenario (``exclude_if``)."""
    return not value


def kind_of(default: str) -> Callable[[Any], str]:
    """Discriminator of a tagged union on ``type`` where a table without one means ``default``."""

    def kind(value: Any) -> str:
        return str(value.get("type", default) if isinstance(value, dict) else getattr(value, "type", default))

    return kind
