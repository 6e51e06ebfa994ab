"""A method's process as the judge holds it: asked with a time-out, watched, its chatter swallowed, and ended for certain."""

import contextlib
import os
import selectors
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from benchmark.isolation.channel import BadMessage, Inbox, framed
from benchmark.isolation.memory import MemoryWatch
from benchmark.isolation.shared import SLOTS, Slot
from benchmark.isolation.surroundings import PROGRAM, environment
from benchmark.isolation.tail import Tail
from benchmark.isolation.wire import pack
from estimators.api import Outcome

_WATCH_S = 0.05  # a process that fills memory at 4 GB/s gets 0.2 GB further
_FAREWELL_S = 1.0
_PIECE = 1 << 20  # bytes read at once, and what the pipe holds
_LAST_PIECES = 4  # what was in the pipe at the end; a child that escaped might go on for ever


T = TypeVar("T")


@dataclass(slots=True, eq=False)
class Ended(Exception):  # noqa: N818 - an end is an outcome
    """The process gave no answer and is no more: how that counts, why, and what it had spent since it was last heard of."""

    outcome: Outcome
    reason: str
    cpu_s: float = 0.0
    wall_s: float = 0.0


class MethodProcess:
    """A fresh interpreter in an empty folder, its own session and process group. Everything it prints goes to ``log``."""

    def __init__(self, hidden: Sequence[Path], log: Tail, memory_bytes: float, *, with_working_directory: bool) -> None:
        """Starts it; it imports what it needs while this process goes on."""
        self._log, self._memory_bytes = log, memory_bytes
        self._folder = tempfile.TemporaryDirectory(prefix="hardlight-method-", ignore_cleanup_errors=True)
        self._slots = [Slot() for _ in range(SLOTS)]
        self._held: frozenset[int] = frozenset()
        self._channel, theirs = socket.socketpair()
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-c", PROGRAM, *(str(slot.fd) for slot in self._slots)],
                stdin=theirs.fileno(),
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                cwd=self._folder.name,
                env=environment(hidden, with_working_directory=with_working_directory),
                pass_fds=[slot.fd for slot in self._slots],
                start_new_session=True,
            )
        assert self._process.stdout is not None
        self._memory = MemoryWatch(self._process.pid, memory_bytes)
        self._printed = self._process.stdout.fileno()
        _prepare(self._printed)
        self._heard: selectors.BaseSelector = selectors.DefaultSelector()
        self._heard.register(self._channel, selectors.EVENT_READ)
        self._heard.register(self._printed, selectors.EVENT_READ)
        self._spent_s = 0.0
        self._watched = 0.0

    def ask(self, do: str, value: object, timeout_s: float, read: Callable[[dict[str, Any]], T]) -> T:
        """What ``read`` makes of its reply. Raises ``Ended`` where there is none; it is then gone with all that it had started."""
        parts, began = pack(value), time.perf_counter()
        try:
            slot = next(index for index in range(SLOTS) if index not in self._held)
            self._channel.sendall(framed({"do": do, "slot": slot, "lengths": self._slots[slot].put(parts)}))
            reply = self._reply(began + timeout_s)
            self._spent_s, self._held = float(reply["spent_s"]), frozenset(reply["held"]) - {SLOTS - 1}
            return read(reply)
        except Ended as end:
            raise self._end(end, began) from None
        except TimeoutError:
            raise self._end(Ended(Outcome.TIMED_OUT, f"no answer within {timeout_s:g} s"), began) from None
        except (BadMessage, KeyError, TypeError, ValueError):
            raise self._end(Ended(Outcome.CRASHED, "its process sent something that is no answer"), began) from None
        except OSError:  # the channel broke
            raise self._end(Ended(Outcome.CRASHED, self._how_it_ended()), began) from None

    def close(self) -> None:
        """Lets it end by itself, which it does at once unless it hangs, then kills what is left."""
        if self._process.returncode is None:
            self._channel.close()
            self._wait_for_its_end(_FAREWELL_S)
            self._kill()

    def _reply(self, deadline: float) -> dict[str, Any]:
        inbox = Inbox()
        while True:
            self._watch()
            left = deadline - time.perf_counter()
            if left <= 0:
                raise TimeoutError
            for key, _ in self._heard.select(min(left, _WATCH_S)):
                if key.fileobj == self._printed:
                    self._read_what_it_printed()
                elif (message := self._read_message(inbox)) is not None:
                    return message

    def _read_message(self, inbox: Inbox) -> dict[str, Any] | None:
        piece = self._channel.recv(1 << 16)
        if not piece:
            raise Ended(Outcome.CRASHED, self._how_it_ended())
        return inbox.add(piece)

    def _read_what_it_printed(self) -> bool:
        """Takes what there is; whether there was something."""
        try:
            piece = os.read(self._printed, _PIECE)
        except BlockingIOError:
            return False
        if piece:
            self._log.add(piece)
        elif self._printed in self._heard.get_map():  # it closed its outputs
            self._heard.unregister(self._printed)
        return bool(piece)

    def _watch(self) -> None:
        """Raises ``Ended`` where the process has died or uses too much memory; looks now and then."""
        now = time.perf_counter()
        if now - self._watched < _WATCH_S:
            return
        self._watched = now
        if self._memory.exceeded():
            raise Ended(Outcome.CRASHED, f"its process used more than {self._memory_bytes / 2**30:g} GiB")
        if _has_died(self._process.pid):  # a child of its own may still hold the channel open
            raise Ended(Outcome.CRASHED, self._how_it_ended())

    def _how_it_ended(self) -> str:
        """In words; a process that only closed the channel did not end."""
        self._wait_for_its_end(_FAREWELL_S)
        if not _has_died(self._process.pid):
            return "its process closed the channel to the judge"
        status = os.waitid(os.P_PID, self._process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)
        assert status is not None
        if status.si_code == os.CLD_EXITED:
            return f"its process ended with status {status.si_status}"
        return f"its process was killed by signal {status.si_status} ({signal.strsignal(status.si_status) or 'no name'})"

    def _wait_for_its_end(self, patience_s: float) -> None:
        deadline = time.perf_counter() + patience_s
        while not _has_died(self._process.pid) and time.perf_counter() < deadline:
            if not self._read_what_it_printed():
                time.sleep(0.002)

    def _end(self, end: Ended, began: float) -> Ended:
        end.cpu_s, end.wall_s = max(0.0, self._kill() - self._spent_s), time.perf_counter() - began
        return end

    def _kill(self) -> float:
        """Kills the whole process group, keeps the last of the log, and returns the CPU seconds that it had spent in all."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        _, status, usage = os.wait4(self._process.pid, 0)
        self._process.returncode = os.waitstatus_to_exitcode(status)
        for _ in range(_LAST_PIECES):
            self._read_what_it_printed()
        self._heard.close()
        self._memory.close()
        self._channel.close()
        for slot in self._slots:
            slot.close()
        assert self._process.stdout is not None
        self._process.stdout.close()
        self._folder.cleanup()
        return usage.ru_utime + usage.ru_stime


def _prepare(printed: int) -> None:
    """Reading must not wait, and a pipe that holds more lets a talkative method be read with fewer calls."""
    os.set_blocking(printed, False)
    if sys.platform == "linux":
        import fcntl

        with contextlib.suppress(OSError):  # the user's share of pipe memory is used up
            fcntl.fcntl(printed, fcntl.F_SETPIPE_SZ, _PIECE)


def _has_died(pid: int) -> bool:
    return os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None
