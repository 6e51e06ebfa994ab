"""Arguments and options that several verbs of the command line share."""

from pathlib import Path
from typing import Annotated

import typer

Out = Annotated[Path, typer.Option("--out", help="Folder for the result; made if it is not there.")]
Data = Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of a data set.")]
Answers = Annotated[Path, typer.Argument(metavar="PREDICTIONS", help="Folder with predictions.csv and run.json.")]
Method = Annotated[str, typer.Argument(metavar="METHOD", help="A registered estimator or package.module:Class.")]
Feature = Annotated[str | None, typer.Option(help="Which feature of the target the method is told of.")]
PriorSigma = Annotated[float, typer.Option(min=0, help="Noise of the corner pixels it is given, sd in px.")]
Rig = Annotated[str | None, typer.Option(help="Which stereo rig measures a ring, where there are several.")]
Lidar = Annotated[str | None, typer.Option(help="Which LIDAR it answers for, where there are other sensors.")]
Model = Annotated[bool, typer.Option("--model", help="Tell it the target's surface, for a LIDAR.")]
Workers = Annotated[int, typer.Option(min=1, max=256, help="Processes that render; the bytes do not depend on it.")]
Answerers = Annotated[int, typer.Option(min=1, max=256, help="Processes that render, and that answer, an entry each.")]
Quality = Annotated[
    str | None,
    typer.Option(metavar="PRESET", help="reference, standard, fast or draft instead of the scenario's own quality."),
]
Overrides = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Replace a value; repeatable.")]
InProcess = Annotated[
    bool, typer.Option("--in-process", help="Run methods in this process, to debug one: a crash or a hang is then everybody's.")
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress, only results and errors.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]


def example(command: str) -> str:
    """The last lines of a verb's help, not to be wrapped."""
    return f"\b\nExample:\n  {command}"
