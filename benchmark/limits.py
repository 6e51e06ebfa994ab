"""How long a method may take and how much memory it may use before it is stopped, and how often it is then started anew."""

from collections.abc import Mapping
from typing import Annotated, Self

from pydantic import Field, ValidationError

from scenes.errors import UsageError
from scenes.spec import Positive, Spec


class Limits(Spec):
    """What one method may cost on one data set.

    ``step_timeout_s``: wall seconds for a frame. ``start_timeout_s``: for its imports and its ``start`` together. ``memory_gib``:
    resident memory of its process and that one's children. ``restarts``: how often it is started anew after it was stopped or
    its process ended; afterwards the remaining frames are not asked.
    """

    step_timeout_s: Positive = 30.0
    start_timeout_s: Positive = 120.0
    memory_gib: Positive = 4.0
    restarts: Annotated[int, Field(ge=0, le=1000)] = 3

    @classmethod
    def of(cls, given: Mapping[str, float]) -> Self:
        """The limits that were typed. Raises ``UsageError`` with what was given and what may be."""
        try:
            return cls.model_validate(given)
        except ValidationError as error:
            first = error.errors()[0]
            raise UsageError(f"{first['loc'][0]} is {first['input']}: {first['msg'].lower()}") from None
