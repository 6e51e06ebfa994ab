"""A process that renders beside others: it leaves Ctrl-C to its parent and keeps to its share of the cores."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager


def start(threads: int) -> None:
    """Readies this process; before anything is rendered in it."""
    from renderer.variant import activate

    signal.signal(signal.SIGINT, signal.SIG_IGN)
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
