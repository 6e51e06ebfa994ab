"""The search for the worst place of a unit cube: a budget of trials, each kept once it is done, so that a killed search goes on."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from benchmark.progress import Progress
from benchmark.study.search_proposals import Axis, Sampler, Tried, evenly, proposed, wrapped
from scenes.arrays import Floats
from scenes.errors import StorageError

if TYPE_CHECKING:
    import optuna

Objective = Callable[[Floats], float]
"""What a place (dimensions,) of the unit cube costs; the search looks for the largest."""


@dataclass(frozen=True, slots=True, eq=False)
class SearchRecord:
    """Every trial of a search in the order in which they were done; the first ``startup`` ones were spread evenly."""

    sampler: Sampler
    seed: int
    startup: int
    tried: tuple[Tried, ...]

    @property
    def worst(self) -> int:
        """The place in ``tried`` of the largest value; of equal ones the first."""
        return int(np.argmax([one.value for one in self.tried]))

    @property
    def so_far(self) -> Floats:
        """(trials,) the largest value up to each trial."""
        return np.asarray(np.maximum.accumulate([one.value for one in self.tried]))


def search(
    objective: Objective,
    dimensions: Sequence[Axis],
    trials: int,
    seed: int,
    storage: Path,
    sampler: Sampler = "tpe",
    progress: Progress | None = None,
) -> SearchRecord:
    """Asks ``objective`` at ``trials`` places of the unit cube, whose axes are ``dimensions``, and returns what came of them.

    ``storage``: a file (Optuna's journal) that takes each trial when it is done and not before: a killed search begins again with
    the trial that it was at. Where a trial is placed follows from the seed and the trials before it alone, so an interrupted search
    comes out as one that was not. A quarter of the first budget is spread evenly, all others are where ``sampler`` expects worse.
    """
    kept = _kept(storage, sampler, seed, dimensions)
    tried = _tried(kept)[:trials]
    startup = _startup(kept, trials)
    while len(tried) < trials:
        if progress is not None:
            progress(len(tried), trials)
        unit = wrapped(proposed(sampler, dimensions, tried, startup, seed), dimensions)
        value = float(objective(unit))
        if not np.isfinite(value):
            raise ValueError(f"what is searched for has no value at {unit.tolist()}: {value}")
        kept.add_trial(_trial(unit, value))
        tried.append(Tried(unit, value))
    if progress is not None:
        progress(trials, trials)
    return SearchRecord(sampler, seed, min(startup, trials), tuple(tried))


def spread(dimensions: Sequence[Axis], trials: int, seed: int, storage: Path, sampler: Sampler) -> Floats:
    """(n, dimensions) the places that such a search begins with, which are known before it begins."""
    startup = _startup(_kept(storage, sampler, seed, dimensions), trials)
    return evenly(len(dimensions), startup, seed)[:startup]


def _startup(kept: "optuna.Study", trials: int) -> int:
    """How many trials are spread evenly. It stays when the budget grows: CMA-ES is told again what it asked, in its order."""
    if "startup" not in kept.user_attrs:
        kept.set_user_attr("startup", -(-trials // 4))
    return int(kept.user_attrs["startup"])


def _kept(storage: Path, sampler: Sampler, seed: int, dimensions: Sequence[Axis]) -> "optuna.Study":
    """The journal's searches have a name each. Only what is done ever stands there."""
    import optuna
    from optuna.storages.journal import JournalFileBackend

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    try:
        storage.parent.mkdir(parents=True, exist_ok=True)
        _mend(storage)
        journal = optuna.storages.JournalStorage(JournalFileBackend(str(storage)))
        name = f"{sampler}-{seed}-{''.join(axis[0] for axis in dimensions)}"
        return optuna.create_study(storage=journal, study_name=name, direction="maximize", load_if_exists=True)
    except OSError as error:
        raise StorageError(f"cannot write to {storage}: {error.strerror or error}") from error


def _mend(storage: Path) -> None:
    """Cuts off the line that a kill left half written: Optuna refuses a journal in which another one follows it."""
    if storage.is_file() and (data := storage.read_bytes()) and not data.endswith(b"\n"):
        with storage.open("r+b") as file:
            file.truncate(data.rfind(b"\n") + 1)


def _trial(unit: Floats, value: float) -> "optuna.trial.FrozenTrial":
    import optuna

    distributions: dict[str, optuna.distributions.BaseDistribution] = {
        f"u{axis}": optuna.distributions.FloatDistribution(0.0, 1.0) for axis in range(len(unit))
    }
    params = {f"u{axis}": float(share) for axis, share in enumerate(unit)}
    return optuna.trial.create_trial(params=params, distributions=distributions, value=value)


def _tried(kept: "optuna.Study") -> list[Tried]:
    found = []
    for trial in kept.get_trials(deepcopy=False):
        assert trial.value is not None  # every trial in the journal is complete
        unit = np.array([trial.params[f"u{axis}"] for axis in range(len(trial.params))], dtype=np.float64)
        found.append(Tried(unit, float(trial.value)))
    return found
