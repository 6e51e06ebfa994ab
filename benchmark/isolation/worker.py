"""The process in which a method runs: it is handed its knowledge and one observation after the other, and answers.

It knows no data set: neither its arguments nor its environment, folder or open files lead to one.
"""

import contextlib
import ctypes
import faulthandler
import os
import pickle
import signal
import socket
import sys
from dataclasses import asdict
from typing import Any

from benchmark.answer import Opening, crashed, raised
from benchmark.cpu_time import spent_cpu_s
from benchmark.guarded import IN_START, Guarded, booked_under
from benchmark.isolation.channel import framed, receive
from benchmark.isolation.shared import Slot
from benchmark.isolation.wire import unpack
from estimators import registry
from scenes.errors import UsageError
from scenes.recording import Knowledge, Observation

_SET_PARENT_DEATH_SIGNAL = 1  # prctl(2)


def main() -> None:
    """Serves until the other side closes the channel, which is this process's standard input."""
    _die_with_the_parent()
    faulthandler.enable()  # a segmentation fault leaves its traceback in the log
    slots = [Slot(int(fd)) for fd in sys.argv[1:]]
    for slot in slots:
        os.set_inheritable(slot.fd, False)
    channel, served = _channel(), _Served()
    while (message := receive(channel)) is not None:
        reply = served.reply(message["do"], _given(slots, message["slot"], message["lengths"]))
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(Exception):  # a method may have closed them
                stream.flush()
        held = [index for index, slot in enumerate(slots) if slot.held]
        channel.sendall(framed(reply | {"held": held, "spent_s": spent_cpu_s()}))


class _Served:
    """One method on one sequence."""

    def __init__(self) -> None:
        self._method: Guarded | None = None
        self._sensor = ""

    def reply(self, do: str, value: Any) -> dict[str, Any]:
        """What is sent back. Whatever the method raises, were it a Ctrl-C of its own, is its crash."""
        if do == "start":
            return self._start(*value)
        return {"answer": self._step(value)}

    def _start(self, method: str, parameters: bytes, knowledge: Knowledge) -> dict[str, Any]:
        self._sensor = booked_under(knowledge)
        self._method = Guarded(lambda: registry.load(method, **pickle.loads(parameters)), aloud=True)
        try:
            opening = self._method.start(knowledge)
        except UsageError as error:
            return {"usage": str(error)}
        except BaseException as error:
            opening = Opening(failure=crashed(self._sensor, f"{IN_START}{raised(error)}"))
        failure = None if opening.failure is None else opening.failure.plain()
        return {"opening": asdict(opening) | {"failure": failure}}

    def _step(self, observation: Observation) -> dict[str, Any]:
        assert self._method is not None
        try:
            return self._method.step(observation).plain()
        except BaseException as error:
            return crashed(self._sensor, raised(error)).plain()


def _given(slots: list[Slot], index: int, lengths: list[int]) -> Any:
    """The value in a slot. What came through the last one is copied, so that this one is always free."""
    parts = slots[index].get(lengths)
    return unpack([part.copy() for part in parts] if index == len(slots) - 1 else parts)


def _channel() -> socket.socket:
    """The socket that this process was started with as standard input, which is then empty for the method."""
    channel = socket.socket(fileno=os.dup(0))
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    return channel


def _die_with_the_parent() -> None:
    """Where the system can, it kills this process when its parent dies, however deep the method is in its work."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_SET_PARENT_DEATH_SIGNAL, signal.SIGKILL)
