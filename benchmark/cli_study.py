"""The verbs of lighting studies, for ``benchmark.cli``."""

# ruff: noqa: ARG001 - main reads --debug, because a verb that fails cannot

from pathlib import Path
from typing import Annotated, Literal

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
    hunting = example("hardlight worst sun-sphere --method mono-rectangle --trials 60")
    app.command(short_help="search a study's ranges for the light that hurts a method most", epilog=hunting)(worst)


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


def worst(
    name: Asked,
    method: Annotated[str, typer.Option("--method", help="Which of the study's methods.")],
    modality: Annotated[Literal["mono", "stereo", "lidar"] | None, typer.Option(help="Which of what it answers.")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; out/STUDY/worst/METHOD where left out.")] = None,
    trials: Annotated[int, typer.Option(min=1, max=100_000, help="Points that are tried in all.")] = 60,
    sampler: Annotated[Literal["tpe", "cmaes"], typer.Option(help="What chooses the points after the first quarter.")] = "tpe",
    seed: Annotated[int, typer.Option(min=0, max=2**31 - 1, help="Of the search, not of the pictures.")] = 0,
    avoid_dark: Annotated[bool, typer.Option("--avoid-dark", help="Leave out lights that leave the pose next to unknown.")] = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Search a study's factors, between their ends, for the setting that hurts one method most, and show it.

    A search that was interrupted goes on where it was, and comes out the same; one with more trials goes on from fewer.
    """
    from benchmark import verbs_worst

    verbs_worst.worst(name, method, modality, out, trials, sampler, seed, avoid_dark, Console(quiet))
