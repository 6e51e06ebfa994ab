"""What a person sees: progress with an ETA on a terminal, one line a stage in a log, tables, and errors as one sentence."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

from benchmark.progress import Progress


class Console:
    """The terminal door. ``quiet`` shows results and errors only."""

    def __init__(self, quiet: bool = False) -> None:
        """Progress goes to stderr, results to stdout, so that results can be piped."""
        self.quiet = quiet
        self.live = sys.stderr.isatty() and not quiet

    def say(self, text: str = "") -> None:
        """A line of the result."""
        print(text)

    def note(self, text: str) -> None:
        """A line that is not part of the result; silent with ``quiet``."""
        if not self.quiet:
            print(text, file=sys.stderr, flush=True)

    @contextmanager
    def stage(self, title: str) -> Iterator[Progress | None]:
        """The progress of one stage: a bar with an ETA on a terminal, a line at its end elsewhere."""
        if not self.live:
            yield None
            self.note(f"done: {title}")
            return
        from rich.console import Console as RichConsole
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        columns = (
            TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(),
            TextColumn("left"), TimeRemainingColumn(),
        )  # fmt: skip
        with Bar(*columns, console=RichConsole(stderr=True)) as bar:
            task = bar.add_task(title, total=None)
            yield lambda done, total: bar.update(task, completed=done, total=total)

    def table(self, title: str, rows: Sequence[Mapping[str, str]], groups: Sequence[str] = (), left: bool = False) -> None:
        """Rows of equal keys as a table; ``groups`` (one per row) draws a line wherever it changes; ``left`` aligns texts."""
        if not rows:
            return
        from rich.console import Console as RichConsole

        from benchmark.console_table import table

        # Names of methods come from outside: brackets and colons are letters, not markup or emoji.
        wide = RichConsole(width=None if sys.stdout.isatty() else 160, markup=False, emoji=False)
        wide.print(table(title, rows, groups, left, wide.width))


def complain(verb: str, sentence: str) -> None:
    """An error on stderr: ``hardlight verb: sentence``."""
    print(f"hardlight{' ' + verb if verb else ''}: {sentence}", file=sys.stderr, flush=True)
