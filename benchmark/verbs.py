"""What each verb of the command line does, and what it says."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from benchmark.console import Console
from scenes.errors import FAULT_FOUND, UsageError, unknown

if TYPE_CHECKING:
    from benchmark.leaderboard import Row
    from benchmark.results import Results
    from scenes.scenario import Quality, Scenario

REASONS_SHOWN = 3


def doctor(console: Console) -> int:
    """Prints the findings; 1 if something is missing without which rendering or judging fails."""
    from benchmark import doctor as findings

    found = findings.examine()
    console.table("", [{"": one.name, "found": one.found, "to do": one.remedy} for one in found], left=True)
    missing = [one for one in found if one.is_missing]
    console.say("everything is there" if not missing else "to do:\n" + "\n".join(f"  {one.remedy}" for one in missing))
    return FAULT_FOUND if any(one.stops for one in missing) else 0


def list_(kind: str | None, console: Console) -> None:
    """Prints names with their descriptions."""
    from benchmark import listing

    for one in listing.KINDS if kind is None else (kind,):
        rows = [{one: name, "": text} for name, text in listing.listing(one)]
        console.table("", rows, left=True)


def render(
    scenario: str,
    out: Path,
    frames: str | None,
    seed: int | None,
    overrides: list[str],
    workers: int,
    quality: str | None,
    resume: bool,
    console: Console,
) -> None:
    """Renders a scenario into ``out``, after saying what that will cost."""
    from scenes.dataset_range import parse_frames
    from scenes.scenario import load_scenario

    loaded = load_scenario(scenario, overrides)
    selected = None if frames is None else parse_frames(frames, loaded.frame_count)
    preset = _preset(quality)
    from renderer.generate import generate, settled

    _warn_if_slow(console)
    chosen = range(loaded.frame_count) if selected is None else selected
    _say_plan(settled(loaded, seed, preset), chosen, console)
    count = len(chosen)
    with console.stage(f"render {count} frames") as progress:
        generate(loaded, out, frames=selected, seed=seed, workers=workers, resume=resume, quality=preset, progress=progress)
    console.say(f"{out}: {count} frames")


def _say_plan(scenario: "Scenario", frames: range, console: Console) -> None:
    """What is ahead, and what a few frames tell of it. Raises ``UsageError`` where it cannot work."""
    from renderer.plan import plan

    ahead = plan(scenario, frames)
    console.note(f"plan: {ahead.sentence()}")
    for warning in ahead.warnings:
        console.note(f"warning: {warning}")


def verify(path: Path, sample: int, console: Console) -> int:
    """Prints every fault; 1 if there is one."""
    from benchmark.information import kept
    from scenes.dataset_verify import verify as check

    # Bounds may lie in a data set's folder without being of it: what is wrong with them is not for its own check to say.
    faults = [*(one for one in check(path) if not one.startswith(f"{path / kept.BOUNDS}: ")), *kept.faults(path)]
    if not faults and sample > 0:
        faults += _rendered_again(path, sample, console)
    for fault in faults:
        console.say(fault)
    console.say(f"{path}: {len(faults)} faults" if faults else f"{path}: no fault found")
    return FAULT_FOUND if faults else 0


def _rendered_again(path: Path, sample: int, console: Console) -> list[str]:
    """The faults of ``sample`` evenly spaced frames; none where this machine cannot make the same bits, which is said."""
    from renderer.again import cannot_compare, rerender
    from scenes.dataset import Dataset

    dataset = Dataset.open(path)
    try:
        why = cannot_compare(dataset)
    except ValueError:  # written by another version or another program: whole, but not ours to repeat
        why = "its scenario is not one that this version can read"
    if why:
        console.say(f"no frame was rendered again, which would not give the same bits: {why}")
        return []
    count = min(sample, len(dataset.frames))
    frames = [dataset.frames[index * len(dataset.frames) // count] for index in range(count)]
    faults = []
    with console.stage(f"render {count} frames again") as progress:
        for done, (_, found) in enumerate(rerender(dataset, frames), start=1):
            faults += found
            if progress is not None:
                progress(done, count)
    return faults


def estimate(
    method: str,
    path: Path,
    out: Path,
    told: dict[str, Any],
    overrides: list[str],
    limits: dict[str, float] | None,
    console: Console,
) -> int:
    """Runs one method over a data set and, where every frame failed, says why; 1 if the method could not even start.

    ``told``: what ``benchmark.knowledge.declare`` takes. ``limits``: of the method's own process; None runs it in this one.
    """
    from benchmark import run
    from benchmark.knowledge import declare
    from benchmark.limits import Limits
    from benchmark.methods import parameters_of
    from scenes.dataset import Dataset

    dataset = Dataset.open(path)
    declaration = declare(dataset, **told)
    bounds = None if limits is None else Limits.of(limits)
    with console.stage(f"{method}: {len(dataset.frames)} frames") as progress:
        parameters = parameters_of(overrides)
        answers = run.estimate(method, parameters, dataset, declaration, out, progress=progress, limits=bounds)
    counts = answers.table["outcome"].value_counts()
    console.say(f"{out}: " + ", ".join(f"{count} {outcome}" for outcome, count in counts.items()))
    reasons = run.reasons_of_failure(answers)
    for reason in reasons[:REASONS_SHOWN]:
        console.say("  " + " ".join(reason.split()))
    if len(reasons) > REASONS_SHOWN:
        console.say(f"  and {len(reasons) - REASONS_SHOWN} more reasons, see extras.parquet")
    return FAULT_FOUND if run.could_not_start(answers) else 0


def judge(answers: Path, path: Path, out: Path, settle_s: float, console: Console) -> None:
    """Scores the answers in a folder and prints the tables."""
    import os

    from benchmark import judge as judging
    from benchmark import predictions, results
    from benchmark.made_by import command
    from benchmark.results import CaseHeading, Entry, Results
    from scenes.dataset import Dataset

    given, dataset = predictions.read(answers), Dataset.open(path)
    judging.write(out, judging.judge(given, dataset, settle_s))
    knowledge = given.record.knowledge
    entry = Entry(
        case=path.name,
        feature=None if knowledge is None else knowledge.feature,
        title=given.record.title,
        dataset=os.path.relpath(path, out),
        answers=os.path.relpath(answers, out),
        scores=".",
    )
    title = f"{given.record.title} on {path.name}"
    asked = command("judge", answers, path, "--out", out)
    index = Results(title=title, command=asked, cases=(CaseHeading(name=path.name),), entries=(entry,))
    results.write(out, index)
    _rank(out, index, console)
    _print_table(out, index, console)


def demo(out: Path, workers: int, console: Console) -> None:
    """The demo suite; where rays are traced one by one, a shorter one."""
    from renderer.variant import probe

    bench("demo-slow" if probe().is_scalar else "demo", out, workers, None, False, console)


def bench(suite: str, out: Path, workers: int, quality: str | None, in_process: bool, console: Console) -> None:
    """Runs a suite, ranks its methods, prints the tables, writes the page."""
    from benchmark import bench as benching
    from benchmark.made_by import command, named
    from benchmark.suite import load_suite
    from benchmark.unstarted import unstarted

    loaded, preset = load_suite(suite), _preset(quality)
    _warn_if_slow(console)
    asked = command("bench", named(suite), "--out", out, *([] if quality is None else ["--quality", quality]))
    index = benching.bench(
        loaded, out, workers=workers, quality=preset, stages=console.stage, in_process=in_process, command=asked
    )
    _rank(out, index, console)
    _print_table(out, index, console)
    for sentence in unstarted(out, index):
        console.note(sentence)
    _report_anew(out, index, console)


def _report_anew(folder: Path, index: "Results", console: Console) -> None:
    """Writes the page unless the same lies there."""
    from benchmark import freshness
    from benchmark.report import PAGE

    if freshness.is_reported(folder, index):
        console.say(f"the report: {(folder / PAGE).resolve()}")
        return
    report(folder, console)
    freshness.mark_reported(folder, index)


def report(folder: Path, console: Console) -> None:
    """Writes the page and says where it is."""
    from benchmark import report as page
    from benchmark.archive import require_datasets
    from benchmark.study import search_page, search_record
    from benchmark.study.archive import is_study

    require_datasets(folder)
    if (folder / search_record.FILE).is_file():  # which is a study's folder too
        console.say(f"the page: {search_page.write(folder).resolve()}")
    elif is_study(folder):
        from benchmark.study import page as of_study

        console.say(f"the page: {of_study.write(folder).resolve()}")
    else:
        console.say(f"the report: {page.write(folder).resolve()}")


def _warn_if_slow(console: Console) -> None:
    """Says why rendering will take long, where it will."""
    from renderer.variant import probe

    backend = probe()
    if backend.is_scalar:
        console.note(backend.reason)


def _preset(name: str | None) -> "Quality | None":
    from scenes.scenario import Quality

    for preset in get_args(Quality):
        if name == preset:
            return preset  # type: ignore[no-any-return]
    if name is not None:
        raise UsageError(unknown("quality preset", name, get_args(Quality)))
    return None


def _rank(folder: Path, index: "Results", console: Console) -> None:
    """Writes ranking.json and prints it: a table per division."""
    from benchmark import ranking, ranking_cells
    from benchmark.pool import pool

    found = ranking.ranking(pool(folder, index))
    ranking.write(folder, found)
    if found.divisions:
        console.say(ranking_cells.legend(found))
    for division in found.divisions:
        console.table(ranking_cells.title(division), ranking_cells.cells(division))


def _print_table(folder: Path, index: "Results", console: Console) -> None:
    """A table of the rectangles, one of the rings and one of the LIDARs, which have columns of their own."""
    from benchmark import leaderboard

    every = list(leaderboard.rows(folder, index))
    rings = [row for row in every if row.summary.ring is not None]
    lidars = [row for row in every if row.summary.filter is not None]
    plain = [row for row in every if row not in rings + lidars]
    cells = [{"case": row.entry.case, "feature": row.entry.feature or "—", **row.cells} for row in plain]
    console.table(f"{index.title} (errors in degrees, answered frames only)", cells, _groups(plain))
    cells = [{"case\nfeature": f"{row.entry.case}\n{row.entry.feature or '—'}", **row.cells} for row in rings]
    console.table(f"{index.title}: rings (answered frames only; second lines: ring right, sd, p95)", cells, _groups(rings))
    _print_lidars(lidars, index, console)


def _groups(rows: "list[Row]") -> list[str]:
    return [f"{row.entry.case} {row.entry.feature}" for row in rows]


def _print_lidars(rows: "list[Row]", index: "Results", console: Console) -> None:
    """A line per case and method, its seeds together."""
    from benchmark import filter_cells
    from benchmark.filter_seeds import seeds_lines

    lines = seeds_lines(rows, index.bases)
    cells = [{"case": line.case, **filter_cells.of_line(line)} for line in lines]
    console.table(f"{index.title}: LIDARs (3σ of the last fifth of the time)", cells, [line.case for line in lines])
