"""One method on one sequence, in processes of its own: one after the other, where they die."""

import pickle
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from benchmark.answer import Answer, Opening, crashed, from_plain, opening_from_plain
from benchmark.guarded import IN_START, booked_under
from benchmark.isolation.process import Ended, MethodProcess
from benchmark.isolation.tail import Tail
from benchmark.limits import Limits
from estimators import registry
from scenes.errors import UsageError
from scenes.recording import Knowledge, Observation


class Isolated:
    """The method ``method``, to be used within ``with``. ``hidden``: folders to which nothing that it finds may lead.

    A time-out is the outcome ``timed_out``; a process that died, used too much memory or replied nonsense is ``crashed``.
    Either counts for its frame; for the next one the method is started anew, as long as ``limits`` allow.
    """

    def __init__(self, method: str, parameters: Mapping[str, Any], limits: Limits, hidden: tuple[Path, ...]) -> None:
        """Starts its first process, which imports what it needs while this one goes on."""
        self._method, self._parameters = method, _pickled(method, parameters)
        self._limits, self._hidden, self._log = limits, hidden, Tail()
        self._restarts, self._reason = 0, ""
        self._sensor = ""
        self._knowledge: Knowledge | None = None
        self._failure: Answer | None = None  # what every further frame meets
        self._process: MethodProcess | None = self._launched()

    def __enter__(self) -> Self:
        """Itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None) -> None:
        """Ends its process."""
        if self._process is not None:
            self._process.close()
            self._process = None

    @property
    def log(self) -> bytes:
        """The end of what it printed."""
        return self._log.content()

    def start(self, knowledge: Knowledge) -> Opening:
        """Loads the method in its process and starts it there."""
        self._knowledge, self._sensor = knowledge, booked_under(knowledge)
        opening = self._opened()
        self._failure = opening.failure
        return opening

    def step(self, observation: Observation) -> Answer:
        """The answer to one frame, by a new process where the last one is no more."""
        if self._process is None and self._failure is None:
            self._failure = self._started_anew()
        if self._failure is not None:
            return self._failure
        try:
            return self._running.ask("step", observation, self._limits.step_timeout_s, _answer)
        except Ended as end:
            return self._ended(end)

    @property
    def _running(self) -> MethodProcess:
        if self._process is None:
            raise RuntimeError("a method is started before its first step, and within 'with'")
        return self._process

    def _launched(self) -> MethodProcess:
        from_outside = self._method not in registry.names()
        memory_bytes = self._limits.memory_gib * 2**30
        return MethodProcess(self._hidden, self._log, memory_bytes, with_working_directory=from_outside)

    def _opened(self) -> Opening:
        told = (self._method, self._parameters, self._knowledge)
        try:
            return self._running.ask("start", told, self._limits.start_timeout_s, _opening)
        except Ended as end:
            failed = self._ended(end)
            failure = replace(failed, reason=f"{IN_START}{failed.reason}", cpu_s=0.0, wall_s=0.0)
            return Opening(failed.cpu_s, failed.wall_s, failure)

    def _started_anew(self) -> Answer | None:
        """What every further frame meets, where it cannot be."""
        if self._restarts == self._limits.restarts:
            return crashed(self._sensor, f"not asked, since its {self._restarts} restarts are used up; at last {self._reason}")
        self._restarts += 1
        self._process = self._launched()
        try:
            return self._opened().failure
        except UsageError as error:
            return crashed(self._sensor, f"{IN_START}{error}")

    def _ended(self, end: Ended) -> Answer:
        self._process, self._reason = None, end.reason
        return Answer(self._sensor, end.outcome, reason=end.reason, cpu_s=end.cpu_s, wall_s=end.wall_s)


def _answer(reply: dict[str, Any]) -> Answer:
    return from_plain(reply["answer"])


def _opening(reply: dict[str, Any]) -> Opening:
    if "usage" in reply:
        raise UsageError(str(reply["usage"]))
    return opening_from_plain(reply["opening"])


def _pickled(method: str, parameters: Mapping[str, Any]) -> bytes:
    try:
        return pickle.dumps(dict(parameters))
    except Exception as error:
        raise UsageError(f"method {method!r}: its parameters cannot go to another process: {error}") from error
