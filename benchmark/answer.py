"""One frame's answer as plain numbers, whichever process gave it. What breaks the estimator's contract becomes a crash here.

Nothing that a method returns is believed: its pose, its extras and its texts are looked at once, where it runs, and what goes
on from there is this value.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from numbers import Real
from typing import Any

import numpy as np
from pydantic import FiniteFloat, NonNegativeFloat, TypeAdapter
from scipy.spatial.transform import Rotation

from estimators.api import Estimate, Outcome

RESERVED = ("frame", "sensor", "reason")  # columns of extras.parquet that are not the method's
LONGEST_REASON = 2000  # characters; an exception may quote a whole array
MOST_EXTRAS = 1000
_UNIT_TOLERANCE = 1e-6

Quaternion = tuple[FiniteFloat, FiniteFloat, FiniteFloat, FiniteFloat]
Position = tuple[FiniteFloat, FiniteFloat, FiniteFloat]


@dataclass(frozen=True, slots=True)
class Answer:
    """What stands in one row of predictions.csv and of extras.parquet.

    ``quaternion``: (qw, qx, qy, qz), of length one with qw ≥ 0, present exactly if ``outcome`` is OK. ``translation_m`` in the
    sensor frame. ``cpu_s`` and ``wall_s``: what the method took for it, NaN-free.
    """

    sensor: str
    outcome: Outcome
    quaternion: Quaternion | None = None
    translation_m: Position | None = None
    reason: str = ""
    extras: dict[str, float] = field(default_factory=dict)
    cpu_s: NonNegativeFloat = 0.0
    wall_s: NonNegativeFloat = 0.0

    def plain(self) -> dict[str, Any]:
        """The same as texts, numbers and lists, for JSON."""
        return asdict(self) | {"outcome": self.outcome.value}


@dataclass(frozen=True, slots=True)
class Opening:
    """What a method's ``start`` took, and where it failed the answer that every frame then has."""

    cpu_s: NonNegativeFloat = 0.0
    wall_s: NonNegativeFloat = 0.0
    failure: Answer | None = None


@cache
def _answers() -> TypeAdapter[Answer]:
    """Built where answers are read, which is not where methods run."""
    return TypeAdapter(Answer)


@cache
def _openings() -> TypeAdapter[Opening]:
    return TypeAdapter(Opening)


def from_plain(plain: object) -> Answer:
    """The answer in what another process sent. Raises ``ValueError`` where that is none."""
    answer = _answers().validate_python(plain)
    if (answer.outcome is Outcome.OK) != (answer.quaternion is not None):
        raise ValueError(f"outcome {answer.outcome.value} and pose {answer.quaternion} contradict each other")
    if answer.quaternion is not None and abs(math.hypot(*answer.quaternion) - 1) > _UNIT_TOLERANCE:
        raise ValueError(f"the quaternion has length {math.hypot(*answer.quaternion):.6g}, not 1")
    return answer


def opening_from_plain(plain: object) -> Opening:
    """The opening in what another process sent. Raises ``ValueError`` where that is none."""
    return _openings().validate_python(plain)


def crashed(sensor: str, reason: str) -> Answer:
    """The answer of a method that gave none."""
    return Answer(sensor, Outcome.CRASHED, reason=readable(reason))


def raised(error: BaseException) -> str:
    """An exception as the reason of a crash. Its own text may fail, since the method may have brought its class."""
    try:
        return f"{type(error).__name__}: {error}"
    except Exception:
        return f"{type(error).__name__}, which has no text"


def answer_of(result: object, sensors: Collection[str], sensor: str) -> Answer:
    """``result`` of a method's step where it keeps the contract, else a crash of ``sensor`` that says how it breaks it.

    ``sensors``: those that it may answer for.
    """
    try:
        return _read(result, sensors, sensor)
    except Exception as error:  # an alien object may raise whatever is asked of it
        return crashed(sensor, f"step answered with something that cannot be read: {raised(error)}")


def readable(text: str) -> str:
    """``text`` as valid Unicode of bounded length: a method may say anything, and it is written to files."""
    text = text.encode("utf-8", "replace").decode("utf-8")
    return text if len(text) <= LONGEST_REASON else f"{text[:LONGEST_REASON]}… ({len(text)} characters)"


def _read(result: object, sensors: Collection[str], sensor: str) -> Answer:
    if not isinstance(result, Estimate):
        return crashed(sensor, f"step returned {type(result).__name__}, not an Estimate")
    fault = _fault_of_heading(result, sensors) or _fault_of_pose(result) or _fault_of_extras(result.extras)
    if fault:
        return crashed(sensor, f"step answered {fault}")
    extras = {readable(name): float(value) for name, value in result.extras.items()}
    heading = (str(result.sensor), result.outcome)
    if result.sensor_from_target is None:
        return Answer(*heading, reason=readable(result.reason), extras=extras)
    quaternion = result.sensor_from_target.as_quat(canonical=True, scalar_first=True)
    qw, qx, qy, qz = np.ravel(quaternion).tolist()
    return Answer(*heading, (qw, qx, qy, qz), _position(result.translation_m), readable(result.reason), extras)


def _position(translation_m: object) -> Position | None:
    if translation_m is None:
        return None
    x_m, y_m, z_m = (float(one) for one in np.ravel(np.asarray(translation_m)).tolist())
    return x_m, y_m, z_m


def _fault_of_heading(result: Estimate, sensors: Collection[str]) -> str:
    sensor: Any = result.sensor
    outcome: Any = result.outcome
    reason: Any = result.reason
    if not isinstance(sensor, str) or sensor not in sensors:
        return f"for the unknown sensor {sensor!r}"
    if not isinstance(outcome, Outcome):
        return f"with the outcome {outcome!r}, which is none"
    return "" if isinstance(reason, str) else f"with a reason that is a {type(reason).__name__}, not a text"


def _fault_of_pose(result: Estimate) -> str:
    """What is wrong with the pose, empty if it is one finite rotation, of a quaternion of length one, with a finite position."""
    pose: Any = result.sensor_from_target
    if (result.outcome is Outcome.OK) != (pose is not None):
        return f"with outcome {result.outcome.value} and pose {pose!r}, which contradict each other"
    if pose is not None and not isinstance(pose, Rotation):
        return f"with a pose that is a {type(pose).__name__}, not a Rotation"
    quaternion = [] if pose is None else np.ravel(pose.as_quat()).tolist()
    position = [] if result.translation_m is None else np.ravel(np.asarray(result.translation_m)).tolist()
    if len(quaternion) not in (0, 4) or len(position) not in (0, 3) or not all(map(math.isfinite, quaternion + position)):
        return "with a pose that is not one finite rotation and position"
    if quaternion and abs(math.hypot(*quaternion) - 1) > _UNIT_TOLERANCE:
        return f"with a quaternion of length {math.hypot(*quaternion):.6g}, not 1"
    return ""


def _fault_of_extras(extras: object) -> str:
    """What is wrong with a method's extras, empty if they are named numbers under names of their own."""
    if not isinstance(extras, Mapping):
        return f"with extras that are a {type(extras).__name__}, not named numbers"
    if len(extras) > MOST_EXTRAS:
        return f"with {len(extras)} extras; there is room for {MOST_EXTRAS}"
    for name, value in extras.items():
        if not isinstance(name, str) or name in RESERVED:
            return f"with the extra {name!r}; a name is a text other than {', '.join(RESERVED)}"
        if not _is_number(value):
            return f"with the extra {name!r} = {value!r}, which is not a number"
    return ""


def _is_number(value: object) -> bool:
    if not isinstance(value, Real | np.bool_):
        return False
    try:
        float(value)
    except (OverflowError, ValueError):  # a whole number of more than 308 digits
        return False
    return True
