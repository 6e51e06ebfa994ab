"""What every estimator must do, whoever wrote it: our own methods pass the same checks as a stranger's.

``faults`` takes a factory of fresh estimators and a recording (declared knowledge and successive observations) and returns one
sentence for each broken promise: black pictures and scans without a return do not raise and are not answered (a filter may
predict over them, once it has begun, and says so with the extra ``predicted`` = 1), inputs stay as they were, the same input
gives the same output, every step gives an estimate that keeps its contract, and a re-labelled target frame turns the answer
with it, and moves it where the method was told of a ring or a model. Extras called ``cpu_...`` are times, which are never the
same again.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.conformance_inputs import arrays, changed, moved_cloud, without_returns
from estimators.api import Estimate, Estimator, Outcome
from scenes.recording import Knowledge, Observation

Factory = Callable[[], Estimator]
RELABELLING = Rotation.from_euler("xyz", [20.0, -35.0, 50.0], degrees=True)
SHIFT_M = (0.3, -0.2, 0.5)
_SAME_RAD, _SAME_M = 1e-6, 1e-6
# Methods thin clouds by cells along the axes of a frame, so that other axes choose other points: a fraction of one scan's noise.
_SAME_CLOUD_RAD, _SAME_CLOUD_M = float(np.radians(0.1)), 0.01
_TIMES = "cpu_"


@dataclass(frozen=True, slots=True)
class Promise:
    """One thing that every method must do, and how this one breaks it; without faults it is kept."""

    text: str
    faults: tuple[str, ...] = ()


def faults(make: Factory, knowledge: Knowledge, observations: Sequence[Observation]) -> list[str]:
    """One sentence for each promise that the method breaks on this recording; empty for a conforming method."""
    return [fault for promise in examine(make, knowledge, observations) for fault in promise.faults]


def examine(make: Factory, knowledge: Knowledge, observations: Sequence[Observation]) -> list[Promise]:
    """Every promise that could be tried on this recording; those that hang on one that is broken are left out."""
    first, complaint = _answers(make, knowledge, observations)
    runs = Promise("it answers a recording without raising", (f"the recording: {complaint}",) if complaint else ())
    if complaint:
        return [runs]
    contract = Promise("every step gives an estimate that keeps its contract", tuple(_contract(first, knowledge)))
    if not any(isinstance(one, Estimate) and one.outcome is Outcome.OK for one in first):
        mute = f"it answers none of the {len(first)} frames, so the rest cannot be checked"
        return [runs, contract, Promise("it answers some frame", (mute,))]
    given = (make, knowledge, observations)
    return [
        runs,
        contract,
        Promise("the same input gives the same output", tuple(_same_again(first, *given))),
        Promise("it leaves its inputs as they were", tuple(_inputs_untouched(*given))),
        Promise("it answers no black picture and no empty scan, and says why", tuple(_black(*given))),
        Promise("a re-labelled target frame turns and moves the answer with it", tuple(_relabelled(first, *given))),
    ]


def _answers(make: Factory, knowledge: Knowledge, observations: Sequence[Observation]) -> tuple[list[Estimate], str]:
    """The answers of a fresh estimator, and what it raised if it did."""
    answers: list[Estimate] = []
    try:
        estimator = make()
        estimator.start(knowledge)
        answers.extend(estimator.step(observation) for observation in observations)
    except Exception as error:
        return answers, f"it raises {type(error).__name__}: {error} after {len(answers)} frames"
    return answers, ""


def _contract(answers: Sequence[object], knowledge: Knowledge) -> Iterator[str]:
    for number, answer in enumerate(answers):
        if not isinstance(answer, Estimate):
            yield f"frame {number}: step returns {type(answer).__name__}, not an Estimate"
            return
        if answer.sensor not in {*knowledge.sensors, *knowledge.lidars}:
            yield f"frame {number}: it answers for the unknown sensor {answer.sensor!r}"
        if (answer.outcome is Outcome.OK) != (answer.sensor_from_target is not None):
            yield f"frame {number}: outcome {answer.outcome.value} and a pose {answer.sensor_from_target} contradict each other"
        if answer.outcome is not Outcome.OK and not answer.reason:
            yield f"frame {number}: outcome {answer.outcome.value} without a reason"


def _same_again(
    first: Sequence[Estimate], make: Factory, knowledge: Knowledge, observations: Sequence[Observation]
) -> Iterator[str]:
    again, complaint = _answers(make, knowledge, observations)
    differ = [number for number, (one, two) in enumerate(zip(first, again, strict=False)) if not _equal(one, two)]
    if complaint or differ:
        yield f"the same input gives another output ({complaint or f'first in frame {differ[0]}'})"


def _equal(one: object, two: object) -> bool:
    """Bit for bit: outcome, rotation, translation and extras other than times."""
    if not isinstance(one, Estimate) or not isinstance(two, Estimate):
        return type(one) is type(two)
    if one.outcome is not two.outcome or _untimed(one).keys() != _untimed(two).keys():
        return False
    return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(_numbers(one), _numbers(two), strict=True))


def _untimed(answer: Estimate) -> dict[str, float]:
    return {name: value for name, value in answer.extras.items() if not name.startswith(_TIMES)}


def _numbers(answer: Estimate) -> list[np.ndarray]:
    rotation = np.empty(0) if answer.sensor_from_target is None else answer.sensor_from_target.as_quat()
    position = np.empty(0) if answer.translation_m is None else np.asarray(answer.translation_m)
    extras = _untimed(answer)
    return [rotation, position, np.array([extras[name] for name in sorted(extras)], dtype=np.float64)]


def _inputs_untouched(make: Factory, knowledge: Knowledge, observations: Sequence[Observation]) -> Iterator[str]:
    """Hands over writable copies, so that a method which writes succeeds and is found out."""
    copies = [changed(observation, np.copy) for observation in observations]
    model = None if knowledge.model is None else moved_cloud(knowledge.model, RigidTransform.identity())
    _answers(make, replace(knowledge, model=model), copies)
    for observation, copy in zip(observations, copies, strict=True):
        for what, name, one, other in arrays(observation, copy):
            if not np.array_equal(one, other, equal_nan=True):
                yield f"frame {observation.frame}: it writes into the {what} of {name!r}"
                return
    if knowledge.model is not None and model is not None:
        parts = ("points_target", "normals_target")
        if not all(np.array_equal(getattr(knowledge.model, part), getattr(model, part)) for part in parts):
            yield "it writes into the model that it is told"


def _black(make: Factory, knowledge: Knowledge, observations: Sequence[Observation]) -> Iterator[str]:
    """Black pictures and empty scans in the first frame, and between good ones, must be failures that say so, or predictions."""
    for place in (0, len(observations) // 2):
        recording = list(observations)
        recording[place] = changed(observations[place], np.zeros_like, without_returns)
        what = f"{'a black picture' if observations[place].images else 'a scan without a return'} in frame {place}"
        answers, complaint = _answers(make, knowledge, recording)
        if complaint:
            yield f"{what}: {complaint}"
        elif answers[place].outcome is Outcome.OK:
            if place == 0 or answers[place].extras.get("predicted") != 1.0:
                yield f"{what} is answered with a pose"
        elif not answers[place].reason:
            yield f"{what} fails without a reason"


def _relabelled(
    first: Sequence[Estimate], make: Factory, knowledge: Knowledge, observations: Sequence[Observation]
) -> Iterator[str]:
    """If the target's axes are called otherwise, p' = Q p, the same camera sees sensor_from_target' = sensor_from_target Q⁻¹.

    A rectangle says nothing of the target's origin, so there Q is a rotation; a ring has a centre and a model is made of places,
    so there it also shifts.
    """
    told, relabelling = _told_otherwise(knowledge)
    if told is None:
        return
    turned, complaint = _answers(make, told, observations)
    if complaint:
        yield f"with a re-labelled target frame: {complaint}"
        return
    for number, (one, two) in enumerate(zip(first, turned, strict=True)):
        fault = _fault_of_relabelling(one, two, relabelling, knowledge)
        if fault:
            yield f"frame {number}: a re-labelled target frame {fault}"
            return


def _told_otherwise(knowledge: Knowledge) -> tuple[Knowledge | None, RigidTransform]:
    """The same knowledge in other target axes, None where it does not say how anything lies on the target."""
    if knowledge.ring is not None:
        relabelling = RigidTransform.from_components(SHIFT_M, RELABELLING)
        ring = replace(knowledge.ring, target_from_feature=relabelling * knowledge.ring.target_from_feature)
        return replace(knowledge, ring=ring), relabelling
    if knowledge.model is not None:
        relabelling = RigidTransform.from_components(SHIFT_M, RELABELLING)
        return replace(knowledge, model=moved_cloud(knowledge.model, relabelling)), relabelling
    relabelling = RigidTransform.from_rotation(RELABELLING)
    if knowledge.rectangle is None:
        return None, relabelling
    rectangle = replace(knowledge.rectangle, target_from_feature=RELABELLING * knowledge.rectangle.target_from_feature)
    return replace(knowledge, rectangle=rectangle), relabelling


def _fault_of_relabelling(one: Estimate, two: Estimate, relabelling: RigidTransform, knowledge: Knowledge) -> str:
    """What is wrong with the answer ``two`` in the other axes; empty if it is ``one``, relabelled."""
    if (one.sensor_from_target is None) != (two.sensor_from_target is None):
        return f"changes the outcome to {two.outcome.value}"
    if one.sensor_from_target is None or two.sensor_from_target is None:
        return ""
    same_rad, same_m = (_SAME_RAD, _SAME_M) if knowledge.model is None else (_SAME_CLOUD_RAD, _SAME_CLOUD_M)
    off_rad = float((one.sensor_from_target.inv() * two.sensor_from_target * relabelling.rotation).magnitude())
    if off_rad > same_rad:
        return f"turns the answer by {np.degrees(off_rad):.3g}° too much"
    moves = knowledge.ring is not None or knowledge.model is not None
    if not moves or one.translation_m is None or two.translation_m is None:
        return ""
    origin_m = one.translation_m + one.sensor_from_target.apply(relabelling.inv().translation)
    off_m = float(np.linalg.norm(two.translation_m - origin_m))
    return f"leaves the answer {off_m:.3g} m from where it should be" if off_m > same_m else ""
