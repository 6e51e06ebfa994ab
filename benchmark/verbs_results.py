"""What the verbs do that keep results and compare with kept ones: ``archive`` and ``reproduce``."""

from pathlib import Path
from typing import TYPE_CHECKING

from benchmark.console import Console
from scenes.errors import FAULT_FOUND

if TYPE_CHECKING:
    from benchmark.reproduce import Comparison, Group, Judged

GROUPS: "tuple[Group, ...]" = ("same data", "other data", "ranking")


def archive(folder: Path, target: Path, console: Console) -> None:
    """Keeps what is small, and says how small it is."""
    from benchmark import archive as archiving
    from benchmark.study import archive as of_studies

    if of_studies.is_study(folder):
        names = of_studies.archive(folder, target)
        console.say(f"{target}: {len(names)} files, {sum((target / name).stat().st_size for name in names) / 1e6:.1f} MB")
        return
    kept = archiving.archive(folder, target)
    size = sum((target / name).stat().st_size for name in kept.files)
    frames = sum(one.frames for one in kept.datasets.values())
    console.say(f"{target}: {len(kept.files)} files, {size / 1e6:.1f} MB; digests of {frames} frames")


def reproduce(kept: Path, out: Path, console: Console) -> int:
    """Prints what a re-run reproduces of a reference, and everything that it does not; 1 if there is such a thing."""
    from benchmark import reference
    from benchmark import reproduce as reproducing
    from benchmark.study import archive as of_studies

    of_studies.require_study(kept, out)
    if of_studies.is_study(kept):
        return _study_again(kept, out, console)
    manifest = reference.read(kept)
    if manifest is None:
        console.note(f"{kept} has no {reference.MANIFEST}: whether it was edited cannot be said")
    elif faults := list(reference.faults(kept, manifest)):
        console.table("the reference was edited", [{"": fault} for fault in faults], left=True)
        console.say(f"{kept}: {len(faults)} faults in the reference, nothing was compared")
        return FAULT_FOUND
    found = reproducing.compare(kept, out)
    _say(found, console)
    verdict = "reproduced" if found.is_reproduced else f"{len(found.outside)} outside, {len(found.missing)} entries missing"
    console.say(f"{out} against {kept}: {verdict}")
    return 0 if found.is_reproduced else FAULT_FOUND


def _study_again(kept: Path, out: Path, console: Console) -> int:
    """The same of a study: its scores at every level, against the kept intervals."""
    from benchmark.study.archive import differences

    found = differences(kept, out)
    console.table("not reproduced", [{"": one} for one in found], left=True)
    console.say(f"{out} against {kept}: {f'{len(found)} figures outside' if found else 'reproduced'}")
    return FAULT_FOUND if found else 0


def _say(found: "Comparison", console: Console) -> None:
    rows = [_counted(found, group) for group in GROUPS if found.counts(group) or found.entries[group]]
    console.table("figures of the reference in the re-run", rows)
    strange = [{"case": case, "data set": text} for case, text in found.strange.items()]
    console.table("other data sets, so other bits; their statistics are compared all the same", strange, left=True)
    console.table("not reproduced", [_cells(one) for one in found.outside], left=True)
    console.table("missing in the re-run", [{"entry": name} for name in found.missing], left=True)
    if found.unranked:
        console.say(f"ranks were not compared: {found.unranked}")
    if found.added:
        console.say(f"{found.added} entries are not in the reference")
    if found.cpu_ratio is not None:
        console.say(f"CPU per frame: {found.cpu_ratio:.2f} times the reference's (median over the entries; not judged)")


def _counted(found: "Comparison", group: "Group") -> dict[str, str]:
    counts = found.counts(group)
    entries = "" if group == "ranking" else str(found.entries[group])
    verdicts = {verdict: str(counts[verdict]) for verdict in ("identical", "inside", "outside")}
    return {"": group, "entries": entries, "figures": str(sum(counts.values())), **verdicts}


def _cells(one: "Judged") -> dict[str, str]:
    stated = one.stated
    return {
        "where": one.where,
        "figure": one.figure,
        "reference": "" if stated is None else f"{stated.value:.6g}",
        "between": "" if stated is None else f"{stated.low:.6g} and {stated.high:.6g}",
        "re-run": "" if stated is None else "none" if one.found is None else f"{one.found:.6g}",
    }
