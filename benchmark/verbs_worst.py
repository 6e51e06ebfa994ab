"""What ``hardlight worst`` does, and what it says."""

from pathlib import Path
from typing import TYPE_CHECKING

from benchmark.console import Console

if TYPE_CHECKING:
    from benchmark.study.search_hunt import Hunt
    from benchmark.study.search_page import Line
    from benchmark.study.search_proposals import Sampler
    from benchmark.subjects import Modality


def worst(
    name: str,
    method: str,
    modality: "Modality | None",
    out: Path | None,
    trials: int,
    sampler: "Sampler",
    seed: int,
    avoid_dark: bool,
    console: Console,
) -> None:
    """Searches a study's ranges for the light that hurts a method most, prints what was found, writes the page."""
    from benchmark import results
    from benchmark.study import search_page
    from benchmark.study.search_hunt import Hunt, narrowed
    from benchmark.study.search_run import worst as run
    from benchmark.study.spec import load_study
    from benchmark.unstarted import unstarted

    study = load_study(name)
    hunt = Hunt(narrowed(study, method, modality, avoid_dark), method, modality, trials, seed, sampler, avoid_dark)
    folder = out or Path("out") / study.name / "worst" / method
    with console.stage(f"search {study.name} for {method}") as progress:
        found = run(hunt, folder, progress, _command(hunt, name, folder))
    for sentence in unstarted(folder, results.read(folder)):
        console.note(sentence)
    console.say(found.sentence)
    if found.worst is not None:
        console.say(found.bound_sentence)
    console.table("The worst points", [_cells(line) for line in search_page.lines(found)])
    console.say(f"the page: {search_page.write(folder).resolve()}")


def _command(hunt: "Hunt", name: str, folder: Path) -> str:
    from benchmark.made_by import command, named

    words = ["--method", hunt.method]
    words += [] if hunt.modality is None else ["--modality", hunt.modality]
    words += ["--trials", str(hunt.trials), "--sampler", hunt.sampler, "--seed", str(hunt.seed)]
    words += ["--avoid-dark"] if hunt.avoid_dark else []
    return command("worst", named(name), *words, "--out", folder)


def _cells(line: "Line") -> dict[str, str]:
    return {
        "rank": str(line.rank),
        "setting": line.label,
        "trial": str(line.trial),
        "right": line.right,
        "mean score": line.charge,
        "error, median": line.error,
        "bound, σ": line.bound,
    }
