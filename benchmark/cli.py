"""The command line: wires verbs to the functions that do the work, and ends with 0 (done), 1 (fault found), 2 (wrong usage).

Nothing heavy is imported here, so that ``hardlight --help`` answers at once; the work is in ``benchmark.verbs``.
"""

# ruff: noqa: ARG001 - main reads --debug, because a verb that fails cannot

import sys
from pathlib import Path
from typing import Annotated

import typer

from benchmark import cli_results, cli_study
from benchmark.cli_options import (
    Answerers,
    Answers,
    Data,
    Debug,
    Feature,
    InProcess,
    Lidar,
    Method,
    Model,
    Out,
    Overrides,
    PriorSigma,
    Quality,
    Quiet,
    Rig,
    Workers,
    example,
)
from benchmark.console import Console, complain
from benchmark.listing import KINDS

app = typer.Typer(
    name="hardlight",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help costs half the CPU time
    help="Spacecraft under hard light: render data sets with exact truth, run pose estimators on them, judge the answers.",
    context_settings={"max_content_width": 100},
    epilog="\b\nBegin with          hardlight demo\nEach verb's example  hardlight VERB --help",
)


def _show_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"hardlight {version('hardlight')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[bool, typer.Option("--version", help="Show the version.", callback=_show_version, is_eager=True)] = False,
) -> None:
    """Options that stand before the verb."""


@app.command(short_help="the whole story in about two minutes", epilog=example("hardlight demo --out out/demo"))
def demo(out: Out = Path("out/demo"), workers: Workers = 1, quiet: Quiet = False, debug: Debug = False) -> None:
    """The whole story in about two minutes: render short sequences of cameras and a LIDAR, estimate, judge, write a page."""
    from benchmark import verbs

    verbs.demo(out, workers, Console(quiet))


@app.command(short_help="what this machine can do, and what is missing", epilog=example("hardlight doctor"))
def doctor(debug: Debug = False) -> None:
    """Show backends and versions, what is missing, and the command that installs it."""
    from benchmark import verbs

    raise typer.Exit(verbs.doctor(Console()))


@app.command("list", short_help="what the library holds", epilog=example("hardlight list scenarios"))
def list_(
    kind: Annotated[
        str | None,
        typer.Argument(
            metavar="[KIND]",
            help=f"Only {', '.join(KINDS[:-1])} or {KINDS[-1]}.",
        ),
    ] = None,
    debug: Debug = False,
) -> None:
    """List what the library holds and which estimators are registered."""
    from benchmark import verbs

    verbs.list_(kind, Console())


@app.command(
    short_help="scenario → data set with exact truth",
    epilog=example("hardlight render zhai2014-in-plane --frames 0:40 --out data/in-plane"),
)
def render(
    scenario: Annotated[str, typer.Argument(metavar="SCENARIO", help="A library name or the path of a TOML file.")],
    out: Out,
    frames: Annotated[str | None, typer.Option(metavar="A:B[:STEP]", help="Only these frames, B not included.")] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed instead of the scenario's own.")] = None,
    overrides: Overrides = None,
    workers: Workers = 1,
    quality: Quality = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with a data set that was interrupted.")] = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Render a scenario into a data set: pictures, exact truth, manifest."""
    from benchmark import verbs

    verbs.render(scenario, out, frames, seed, overrides or [], workers, quality, resume, Console(quiet))


@app.command(short_help="every file of a data set against its digest", epilog=example("hardlight verify data/in-plane --sample 2"))
def verify(
    dataset: Data,
    sample: Annotated[int, typer.Option(min=0, help="How many frames to render again and compare.")] = 1,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Check every file of a data set against its digest, and render a sample of frames again."""
    from benchmark import verbs

    raise typer.Exit(verbs.verify(dataset, sample, Console(quiet)))


@app.command(
    short_help="a method answers every frame of a data set",
    epilog=example("hardlight estimate mono-rectangle data/in-plane --feature wing --out answers/wing"),
)
def estimate(
    method: Method,
    dataset: Data,
    out: Out,
    feature: Feature = None,
    prior_sigma_px: PriorSigma = 3.0,
    rig: Rig = None,
    lidar: Lidar = None,
    model: Model = False,
    overrides: Overrides = None,
    step_timeout_s: Annotated[float, typer.Option(min=0.001, help="Wall seconds that one frame may take.")] = 30.0,
    start_timeout_s: Annotated[float, typer.Option(min=0.001, help="Wall seconds that its imports and start may take.")] = 120.0,
    memory_gib: Annotated[float, typer.Option(min=0.001, help="Memory that its process may use.")] = 4.0,
    in_process: InProcess = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Let a method answer every frame of a data set; it sees pictures, scans and its declared knowledge, nothing else."""
    from benchmark import verbs

    told = {"feature_name": feature, "sigma_px": prior_sigma_px, "rig": rig, "lidar": lidar, "grant_model": model}
    limits = {"step_timeout_s": step_timeout_s, "start_timeout_s": start_timeout_s, "memory_gib": memory_gib}
    bounds = None if in_process else limits
    raise typer.Exit(verbs.estimate(method, dataset, out, told, overrides or [], bounds, Console(quiet)))


@app.command(short_help="every fault of a folder of answers", epilog=example("hardlight check answers/wing data/in-plane"))
def check(predictions: Answers, dataset: Data, debug: Debug = False) -> None:
    """Say everything that is wrong with a folder of answers at once: file, line, field and value."""
    from benchmark import verbs_entering

    raise typer.Exit(verbs_entering.check(predictions, dataset, Console()))


@app.command(
    short_help="which promises a method keeps",
    epilog=example("hardlight conform mypackage.mine:Mine data/in-plane --feature wing"),
)
def conform(
    method: Method,
    dataset: Data,
    feature: Feature = None,
    prior_sigma_px: PriorSigma = 3.0,
    rig: Rig = None,
    lidar: Lidar = None,
    model: Model = False,
    frames: Annotated[int, typer.Option(min=1, max=1000, help="How many of the first frames it is tried on.")] = 8,
    overrides: Overrides = None,
    debug: Debug = False,
) -> None:
    """Try a method on what every method must do: say which promises it keeps and how it breaks the others."""
    from benchmark import verbs_entering

    told = {"feature_name": feature, "sigma_px": prior_sigma_px, "rig": rig, "lidar": lidar, "grant_model": model}
    raise typer.Exit(verbs_entering.conform(method, dataset, told, overrides or [], frames, Console()))


@app.command(short_help="answers against the truth", epilog=example("hardlight judge answers/wing data/in-plane --out scores/wing"))
def judge(
    predictions: Answers,
    dataset: Data,
    out: Out,
    settle_s: Annotated[float, typer.Option(min=0, help="Seconds at the start that are answered but not judged.")] = 0.0,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Compare answers with the truth: a row a frame, a summary with intervals, failures counted."""
    from benchmark import verbs

    verbs.judge(predictions, dataset, out, settle_s, Console(quiet))


@app.command(short_help="a suite: render, estimate, judge, report", epilog=example("hardlight bench zhai2014 --out out/zhai2014"))
def bench(
    suite: Annotated[str, typer.Argument(metavar="SUITE", help="A library name or the path of a TOML file.")],
    out: Out,
    workers: Answerers = 1,
    quality: Quality = None,
    in_process: InProcess = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Run a suite: render or reuse its data sets, let every method answer, judge, print the table, write the page."""
    from benchmark import verbs

    verbs.bench(suite, out, workers, quality, in_process, Console(quiet))


@app.command(short_help="results → one self-contained page", epilog=example("hardlight report out/zhai2014"))
def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="The --out folder of bench, demo or judge.")],
    debug: Debug = False,
) -> None:
    """Write report.html, one self-contained page, from results that are there."""
    from benchmark import verbs

    verbs.report(folder, Console())


cli_study.register(app)
cli_results.register(app)

INTERRUPTED = {
    "render": "interrupted; finished frames are kept, the same command with --resume goes on",
    "bench": "interrupted; finished frames are kept, the same command goes on",
    "study": "interrupted; finished points are kept, the same command goes on",
    "worst": "interrupted; finished trials are kept, the same command goes on",
    "demo": "interrupted; finished frames are kept, the same command goes on",
}


def main(arguments: list[str] | None = None) -> None:
    """Entry point: runs the command and ends the process with its exit status."""
    arguments = sys.argv[1:] if arguments is None else arguments
    verb = arguments[0] if arguments and not arguments[0].startswith("-") else ""
    try:
        status = app(args=arguments, prog_name="hardlight", standalone_mode=False)
    except Exception as error:
        status = _failed(error, verb, arguments)
    if status == 130:
        complain(verb, INTERRUPTED.get(verb, "interrupted"))
    sys.exit(status if isinstance(status, int) else 0)


def _failed(error: Exception, verb: str, arguments: list[str]) -> int:
    """Says in one sentence what went wrong and returns the exit status; with ``--debug`` the traceback goes first."""
    from benchmark.failure import describe, is_interruption

    if is_interruption(error):
        return 130

    if "--debug" in arguments:
        import traceback

        traceback.print_exception(error)
    sentence, status = describe(error, verb, arguments)
    if sentence:
        complain(verb, sentence)
    return status


if __name__ == "__main__":
    main()
