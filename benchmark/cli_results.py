"""The verbs that keep results, compare with kept ones, and say how good they could be, for ``benchmark.cli``."""

# ruff: noqa: ARG001 - main reads --debug, because a verb that fails cannot

from pathlib import Path
from typing import Annotated

import typer

from benchmark.cli_options import Data, Debug, Quiet, example
from benchmark.console import Console

Results = Annotated[Path, typer.Argument(metavar="DIR", help="The --out folder of bench.")]
Reference = Annotated[Path, typer.Argument(metavar="REFERENCE", help="What hardlight archive kept, or a bench's --out folder.")]
To = Annotated[Path, typer.Option("--to", help="Folder that takes it; replaced if it holds the same suite's archive.")]
Frames = Annotated[str | None, typer.Option(help="Part of the data set's frames, START:STOP[:STEP], by their place in it.")]
Beside = Annotated[Path | None, typer.Option("--out", help="Folder for bounds.parquet; left out, the data set's own.")]
Light = Annotated[bool, typer.Option("--light-direction", help="Count the key light's direction as not known, too.")]
Given = Annotated[Path | None, typer.Option("--answers", help="Answers on the data set, to be held against the bound.")]


def register(app: typer.Typer) -> None:
    """Gives ``app`` the verbs."""
    archiving = example("hardlight archive out/zhai2014 --to results/zhai2014")
    app.command(short_help="results → what is small of them, to be kept", epilog=archiving)(archive)
    comparing = example("hardlight reproduce results/zhai2014 out/zhai2014")
    app.command(short_help="a re-run against kept results", epilog=comparing)(reproduce)
    bounding = example("hardlight bound data/in-plane --answers answers/wing")
    app.command(short_help="how well anybody could know the pose", epilog=bounding)(bound)


def archive(folder: Results, target: To, debug: Debug = False) -> None:
    """Keep of results the index, ranking, page and summaries, and digests of every file and frame: no frames."""
    from benchmark import verbs_results

    verbs_results.archive(folder, target, Console())


def reproduce(reference: Reference, folder: Results, quiet: Quiet = False, debug: Debug = False) -> None:
    """Check that results have the reference's entries, figures within its intervals, and its ranks."""
    from benchmark import verbs_results

    raise typer.Exit(verbs_results.reproduce(reference, folder, Console(quiet)))


def bound(
    dataset: Data,
    out: Beside = None,
    frames: Frames = None,
    answers: Given = None,
    light_direction: Light = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """The Cramér-Rao bound on the pose of every picture and scan, from the rendered signal and the sensor's noise.

    Pictures cost 24 renderings each. Shape, materials and light count as known: it is the limit of light and sensor. What is found
    is kept in bounds.parquet, so that a run which was ended goes on; scores judged afterwards have it beside their errors.
    """
    from benchmark import verbs_bound

    verbs_bound.bound(dataset, out, frames, answers, light_direction, Console(quiet))
