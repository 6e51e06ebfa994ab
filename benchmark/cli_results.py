"""The verbs that keep results and compare with kept ones, for ``benchmark.cli``."""

# ruff: noqa: ARG001 - main reads --debug, because a verb that fails cannot

from pathlib import Path
from typing import Annotated

import typer

from benchmark.cli_options import Debug, Quiet, example
from benchmark.console import Console

Results = Annotated[Path, typer.Argument(metavar="DIR", help="The --out folder of bench.")]
Reference = Annotated[Path, typer.Argument(metavar="REFERENCE", help="What hardlight archive kept, or a bench's --out folder.")]
To = Annotated[Path, typer.Option("--to", help="Folder that takes it; replaced if it holds the same suite's archive.")]


def register(app: typer.Typer) -> None:
    """Gives ``app`` the verbs."""
    archiving = example("hardlight archive out/zhai2014 --to results/zhai2014")
    app.command(short_help="results → what is small of them, to be kept", epilog=archiving)(archive)
    comparing = example("hardlight reproduce results/zhai2014 out/zhai2014")
    app.command(short_help="a re-run against kept results", epilog=comparing)(reproduce)


def archive(folder: Results, target: To, debug: Debug = False) -> None:
    """Keep of results the index, ranking, page and summaries, and digests of every file and frame: no frames."""
    from benchmark import verbs_results

    verbs_results.archive(folder, target, Console())


def reproduce(reference: Reference, folder: Results, quiet: Quiet = False, debug: Debug = False) -> None:
    """Check that results have the reference's entries, figures within its intervals, and its ranks."""
    from benchmark import verbs_results

    raise typer.Exit(verbs_results.reproduce(reference, folder, Console(quiet)))
