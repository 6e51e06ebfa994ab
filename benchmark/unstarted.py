"""Methods that never began: what a person has to know before reading a table in which they are last."""

from collections.abc import Iterator
from pathlib import Path

from benchmark import predictions, results
from benchmark.guarded import IN_START
from benchmark.results import Entry, Results
from benchmark.run import could_not_start, reasons_of_failure


def unstarted(folder: Path, index: Results) -> Iterator[str]:
    """A sentence for each method that could not start where it was asked: for the wrong thing, say, or without what it needs."""
    for title in dict.fromkeys(entry.title for entry in index.entries):
        mine = [entry for entry in index.entries if entry.title == title]
        reasons = [reason for entry in mine if (reason := _reason(folder, entry))]
        if reasons:
            yield f"{title} could not start in {len(reasons)} of {len(mine)} entries; the first reason: {reasons[0]}"


def _reason(folder: Path, entry: Entry) -> str:
    """Why it could not start, empty where it did."""
    if any(one.answered for one in results.summaries(folder, entry)):
        return ""
    answers = predictions.read(folder / entry.answers)
    return reasons_of_failure(answers)[0].removeprefix(IN_START) if could_not_start(answers) else ""
