"""A method that cannot do harm by raising: started once, then asked frame by frame, each time timed, each time with an answer."""

import sys
import traceback
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

from benchmark.answer import Answer, Opening, answer_of, crashed, raised
from benchmark.cpu_time import Stopwatch
from estimators.api import Estimator
from scenes.errors import UsageError
from scenes.recording import Knowledge, Observation

IN_START = "start: "


class Answerer(Protocol):
    """A method as the loop sees it, wherever it runs."""

    def start(self, knowledge: Knowledge) -> Opening:
        """Raises ``UsageError`` where the method does not exist or refuses its parameters, and nothing else."""

    def step(self, observation: Observation) -> Answer:
        """The answer to one frame; never raises."""


class Guarded:
    """The method that ``make`` builds, in this process. ``aloud`` prints the traceback of what it raises.

    An exception is the outcome ``crashed`` with its text, and so is an attempt to end the process by sys.exit. Ctrl-C is the
    user's and goes through.
    """

    def __init__(self, make: Callable[[], Estimator], *, aloud: bool = False) -> None:
        """Builds nothing yet: what a constructor does belongs to the start."""
        self._make, self._aloud = make, aloud
        self._sensors: frozenset[str] = frozenset()
        self._sensor = ""
        self._estimator: Estimator | None = None

    def start(self, knowledge: Knowledge) -> Opening:
        """Builds the method and starts it; only the latter is timed."""
        self._sensor, self._sensors = booked_under(knowledge), frozenset([*knowledge.sensors, *knowledge.lidars])
        watch = Stopwatch()
        try:
            self._estimator = self._make()
            with watch.running():
                self._estimator.start(knowledge)
        except UsageError:
            raise
        except (Exception, SystemExit) as error:
            return Opening(watch.cpu_s, watch.wall_s, self._failed(f"{IN_START}{raised(error)}"))
        return Opening(watch.cpu_s, watch.wall_s)

    def step(self, observation: Observation) -> Answer:
        """The answer to one frame."""
        watch = Stopwatch()
        try:
            with watch.running():
                result = self._estimator.step(observation) if self._estimator is not None else None
        except (Exception, SystemExit) as error:
            answer = self._failed(raised(error))
        else:
            answer = answer_of(result, self._sensors, self._sensor)
        return replace(answer, cpu_s=watch.cpu_s, wall_s=watch.wall_s)

    def _failed(self, reason: str) -> Answer:
        if self._aloud:
            traceback.print_exc(file=sys.stderr)
        return crashed(self._sensor, reason)


def booked_under(knowledge: Knowledge) -> str:
    """The sensor that a crash counts for: a rig's left camera, the first camera, or the first LIDAR where no feature is told of."""
    if knowledge.pair is not None:
        return knowledge.pair.left
    if knowledge.lidars and (knowledge.rectangle is None or not knowledge.sensors):
        return next(iter(knowledge.lidars))
    return next(iter(knowledge.sensors))
