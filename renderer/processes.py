"""Jobs in processes of their own, several at a time: fresh ones, since what renderers and methods load cannot be forked."""

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from renderer.worker import belong, interrupts_held
from scenes.errors import HardlightError

Job = TypeVar("Job")
Outcome = TypeVar("Outcome")


def done_in_processes(
    work: Callable[[Job], Outcome],
    jobs: Sequence[Job],
    workers: int,
    start: Callable[..., None] = belong,
    arguments: tuple[Any, ...] = (),
    advice: str = "what is finished is kept, try --workers 1",
) -> Iterator[tuple[Job, Outcome]]:
    """Every job with what ``work`` makes of it, as they end; ``start(*arguments)`` readies a process, which belongs to this one.

    The first error that ``work`` raises ends the rest. Raises ``HardlightError`` with ``advice`` where a process dies.
    """
    spawn = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(min(workers, max(1, len(jobs))), mp_context=spawn, initializer=start, initargs=arguments)
    try:
        with interrupts_held():  # the first job that is handed in starts the processes
            futures: dict[Future[Outcome], Job] = {pool.submit(work, job): job for job in jobs}
        for future in as_completed(futures):
            yield futures[future], future.result()
    except BrokenProcessPool:
        raise HardlightError(
            "a worker process died (killed, out of memory, or started from a script without "
            f"`if __name__ == '__main__':`); {advice}"
        ) from None
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
