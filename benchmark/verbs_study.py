"""What ``hardlight study`` does, and what it says."""

from pathlib import Path
from typing import TYPE_CHECKING

from benchmark.console import Console

if TYPE_CHECKING:
    from benchmark.study.spec import Study


def study(name: str, out: Path | None, workers: int, only_plan: bool, console: Console) -> None:
    """Runs a study, prints its scores, writes the page; with ``only_plan`` says what it would cost."""
    from benchmark.study.spec import load_study

    loaded = load_study(name)
    if only_plan:
        _plan(loaded, workers, console)
        return
    _run(loaded, name, out or Path("out") / loaded.name, workers, console)


def _plan(study: "Study", workers: int, console: Console) -> None:
    from benchmark.study.plan import plan

    with console.stage("plan: two points are tried"):
        ahead = plan(study, workers)
    console.say(ahead.sentence())


def _run(study: "Study", name: str, out: Path, workers: int, console: Console) -> None:
    from benchmark.made_by import command, named
    from benchmark.study import page, scores
    from benchmark.study.outcomes import outcomes
    from benchmark.study.run import study as run
    from benchmark.study.score_cells import tables
    from benchmark.unstarted import unstarted

    asked = command("study", named(name), "--out", out)
    with console.stage(f"study {study.name}") as progress:
        index = run(study, out, workers=workers, progress=progress, command=asked)
    found = outcomes(out)
    for point, reason in found.record.refused.items():
        console.note(f"left out: {point}: {reason}")
    for sentence in unstarted(out, index):
        console.note(sentence)
    scored = scores.study_scores(found)
    scores.write(out, scored)
    for title, rows in tables(scored):
        console.table(title, rows)
    console.say(f"the page: {page.write(out).resolve()}")
