"""The command line: wires verbs to the functions that do the work, and ends with 0 (done), 1 (fault found), 2 (wrong usage).

Nothing heavy is imported here, so that ``hardlight --help`` answers at once; the work is in ``benchmark.verbs``.
"""

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from benchmark.console import Console, complain

app = typer.Typer(
    name="hardlight",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    help="Spacecraft under hard light: render data sets with exact truth, run pose estimators on them, judge the answers.",
    epilog="Begin with:  hardlight demo    What is there:  hardlight list    What works here:  hardlight doctor",
)


class Kind(StrEnum):
    """What ``hardlight list`` can list."""

    SCENARIOS = "scenarios"
    ESTIMATORS = "estimators"
    SUITES = "suites"
    TARGETS = "targets"
    CAMERAS = "cameras"
    LIGHTS = "lights"
    MATERIALS = "materials"


class Preset(StrEnum):
    """Rendering quality."""

    REFERENCE = "reference"
    STANDARD = "standard"
    FAST = "fast"
    DRAFT = "draft"


Out = Annotated[Path, typer.Option("--out", help="Folder for the result; made if it is not there.")]
Data = Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of a data set.")]
Workers = Annotated[int, typer.Option(min=1, max=256, help="Processes that render; the bytes do not depend on it.")]
Quality = Annotated[Preset | None, typer.Option(help="Rendering quality instead of the scenario's own.")]
Overrides = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Replace a value; repeatable.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress, only results and errors.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]


@app.command(epilog="Example:  hardlight demo --out out/demo")
def demo(out: Out = Path("out/demo"), workers: Workers = 1, quiet: Quiet = False, debug: Debug = False) -> None:
    """The whole story in about two minutes: render two short fly-arounds, estimate, judge, write a page."""
    from benchmark import verbs

    verbs.bench("demo", out, workers, None, Console(quiet))


@app.command(epilog="Example:  hardlight doctor")
def doctor(debug: Debug = False) -> None:
    """Show backends and versions, what is missing, and the command that installs it."""
    from benchmark import verbs

    raise typer.Exit(verbs.doctor(Console()))


@app.command("list", epilog="Example:  hardlight list scenarios")
def list_(kind: Annotated[Kind | None, typer.Argument(help="Only this kind.")] = None, debug: Debug = False) -> None:
    """List what the library holds and which estimators are registered."""
    from benchmark import verbs

    verbs.list_(None if kind is None else kind.value, Console())


@app.command(epilog="Example:  hardlight render zhai2014-in-plane --frames 0:40 --out data/in-plane")
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

    preset = None if quality is None else quality.value
    verbs.render(scenario, out, frames, seed, overrides or [], workers, preset, resume, Console(quiet))


@app.command(epilog="Example:  hardlight verify data/in-plane --sample 2")
def verify(
    dataset: Data,
    sample: Annotated[int, typer.Option(min=0, help="How many frames to render again and compare.")] = 1,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Check every file of a data set against its digest, and render a sample of frames again."""
    from benchmark import verbs

    raise typer.Exit(verbs.verify(dataset, sample, Console(quiet)))


@app.command(epilog="Example:  hardlight estimate mono-rectangle data/in-plane --feature wing --out answers/wing")
def estimate(
    method: Annotated[str, typer.Argument(metavar="METHOD", help="A registered estimator or package.module:Class.")],
    dataset: Data,
    out: Out,
    feature: Annotated[str | None, typer.Option(help="Which feature of the target the method is told of.")] = None,
    prior_sigma_px: Annotated[float, typer.Option(min=0, help="Noise of the corner pixels it is given, sd in px.")] = 3.0,
    overrides: Overrides = None,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Let a method answer every frame of a data set; it sees pictures and its declared knowledge, nothing else."""
    from benchmark import verbs

    verbs.estimate(method, dataset, out, feature, prior_sigma_px, overrides or [], Console(quiet))


@app.command(epilog="Example:  hardlight judge answers/wing data/in-plane --out scores/wing")
def judge(
    predictions: Annotated[Path, typer.Argument(metavar="PREDICTIONS", help="Folder with predictions.csv and run.json.")],
    dataset: Data,
    out: Out,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Compare answers with the truth: a row a frame, a summary with intervals, failures counted."""
    from benchmark import verbs

    verbs.judge(predictions, dataset, out, Console(quiet))


@app.command(epilog="Example:  hardlight bench zhai2014 --out out/zhai2014")
def bench(
    suite: Annotated[str, typer.Argument(metavar="SUITE", help="A library name or the path of a TOML file.")],
    out: Out,
    workers: Workers = 1,
    quality: Quality = None,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Run a suite: render or reuse its data sets, let every method answer, judge, print the table, write the page."""
    from benchmark import verbs

    verbs.bench(suite, out, workers, None if quality is None else quality.value, Console(quiet))


@app.command(epilog="Example:  hardlight report out/zhai2014")
def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="The --out folder of bench, demo or judge.")],
    debug: Debug = False,
) -> None:
    """Write report.html, one self-contained page, from results that are there."""
    from benchmark import verbs

    verbs.report(folder, Console())


INTERRUPTED = {
    "render": "interrupted; finished frames are kept, the same command with --resume goes on",
    "bench": "interrupted; finished frames are kept, the same command goes on",
    "demo": "interrupted; finished frames are kept, the same command goes on",
}


def main(arguments: list[str] | None = None) -> None:
    """Entry point: runs the command and ends the process with its exit status."""
    arguments = sys.argv[1:] if arguments is None else arguments
    verb = arguments[0] if arguments and not arguments[0].startswith("-") else ""
    try:
        status = app(args=arguments, prog_name="hardlight", standalone_mode=False)
    except Exception as error:
        status = _failed(error, verb, "--debug" in arguments)
    if status == 130:
        complain(verb, INTERRUPTED.get(verb, "interrupted"))
    sys.exit(status if isinstance(status, int) else 0)


def _failed(error: Exception, verb: str, debug: bool) -> int:
    """Says in one sentence what went wrong and returns the exit status; with ``debug`` the traceback goes first."""
    from benchmark.failure import describe

    if debug:
        import traceback

        traceback.print_exception(error)
    sentence, status = describe(error, verb)
    if sentence:
        complain(verb, sentence)
    return status
