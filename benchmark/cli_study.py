"""The verbs of lighting studies, for ``benchmark.cli``."""

# ruff: noqa: ARG001 - main reads --debug, because a verb that fails cannot

from pathlib import Path
from typing import Annotated

import typer

from benchmark.cli_options import Debug, Quiet, example
from benchmark.console import Console

Asked = Annotated[str, typer.Argument(metavar="STUDY", help="A library name or the path of a TOML file.")]
Where = Annotated[Path | None, typer.Option("--out", help="Folder for the result; out/STUDY where left out.")]
Together = Annotated[int, typer.Option("--workers", min=1, max=256, help="Points that are rendered and answered at a time.")]
Planned = Annotated[bool, typer.Option("--plan", help="Only say how many frames, hours and GB it will be.")]


def register(app: typer.Typer) -> None:
    """Gives ``app`` the verbs."""
    studying = example("hardlight study sun-sphere --out out/sun-sphere --workers 2")
    app.command(short_help="which light breaks whom: a factor's levels, all else equal", epilog=studying)(study)


def study(
    name: Asked,
    out: Where = None,
    workers: Together = 1,
    plan: Planned = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Run a study: change the light step by step with all else equal, let every method answer, score, write the page.

    What lies there already and would come out the same is kept, so an interrupted study goes on where it was.
    """
    from benchmark import verbs_study

    verbs_study.study(name, out, workers, plan, Console(quiet))
