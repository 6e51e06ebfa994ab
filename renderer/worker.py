"""Processes that work beside others: they leave Ctrl-C to their parent, end when it does, and keep to their share of the cores."""

import multiprocessing
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.process import BaseProcess
from threading import Thread


def belong() -> None:
    """Makes this process its parent's: Ctrl-C is the parent's to handle, and where the parent is killed, this one ends too."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if (parent := multiprocessing.parent_process()) is not None:
        Thread(target=_end_after, args=(parent,), daemon=True).start()


def start(threads: int) -> None:
    """Readies this process to render, before anything is rendered in it."""
    from renderer.variant import activate

    belong()
    activate()
    import drjit as dr

    dr.set_thread_count(threads)


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Ctrl-C reaches this process afterwards, and those that it starts meanwhile never, not even while they still import."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end_after(parent: BaseProcess) -> None:
    """At once: what is half done is in no file that counts, and the queue of jobs would be waited for in vain."""
    parent.join()
    os._exit(1)
