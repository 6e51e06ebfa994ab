"""A process that renders beside others: it leaves Ctrl-C to its parent and keeps to its share of the cores."""


def start(threads: int) -> None:
    """Readies this process; before anything is rendered in it."""
    import signal

    from renderer.variant import activate

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    activate()
    import drjit as dr

    dr.set_thread_count(threads)
