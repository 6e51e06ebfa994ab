"""The search of one study for the light that hurts a method most; everything lies in one folder, which is a study's and more."""

from pathlib import Path

from benchmark.progress import Progress
from benchmark.run_bounds import FOLDER, forget
from benchmark.study import record, search_record
from benchmark.study.search import SearchRecord, search, spread
from benchmark.study.search_hunt import Hunt
from benchmark.study.search_record import WorstRecord, chosen
from benchmark.study.search_trials import Trials
from benchmark.study.search_worst import costliest, with_bound


def worst(hunt: Hunt, out: Path, progress: Progress | None = None, command: str = "") -> WorstRecord:
    """Searches, keeping what lies in ``out``, and writes there what a study's folder holds, and worst.json.

    Once all is over it returns at once; a larger budget goes on from a smaller one.
    """
    if (there := _finished(hunt, out)) is not None:
        return there
    if not hunt.avoid_dark:  # those of another search would say which frame of the worst point is shown
        forget(out, [path.stem for path in (out / FOLDER).glob("*.parquet")])
    record.write(out, record.record_of(hunt.study, command, {}))
    storage = out / f"trials-{hunt.identity[:10]}.journal"
    trials = Trials(hunt, out, hunt.study.scenario.model_dump(mode="json"))
    if hunt.avoid_dark:
        trials.look(spread(hunt.axes, hunt.trials, hunt.seed, storage, hunt.sampler), progress)
    found = search(trials, hunt.axes, hunt.trials, hunt.seed, storage, hunt.sampler, progress)
    said = _said(hunt, trials, found, command)
    search_record.write(out, said)
    return said


def _said(hunt: Hunt, trials: Trials, found: SearchRecord, command: str) -> WorstRecord:
    frames, told = trials.all_of(found.tried, command)
    place, bound = chosen(told), None
    if place is not None:
        row = costliest(frames[frames["point"] == told[place].point])
        bound = with_bound(hunt.study, trials.point(found.tried[place].unit), row, trials.out)
    return WorstRecord(
        title=hunt.study.title,
        method=hunt.method,
        modality=hunt.modality,
        factors=tuple(one.title for one in hunt.study.factors.values()),
        sampler=hunt.sampler,
        seed=hunt.seed,
        avoid_dark=hunt.avoid_dark,
        command=command,
        identity=hunt.identity,
        startup=found.startup,
        trials=told,
        worst=place,
        bound=bound,
    )


def _finished(hunt: Hunt, out: Path) -> WorstRecord | None:
    """The record in ``out`` if it is this search's."""
    if not (out / search_record.FILE).is_file():
        return None
    there = search_record.read(out)
    same = (there.identity, there.sampler, there.seed, len(there.trials)) == (hunt.identity, hunt.sampler, hunt.seed, hunt.trials)
    return there if same else None
