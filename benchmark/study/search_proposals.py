"""Where a search looks next: evenly spread places first, then what TPE or CMA-ES expects to be worse.

Each proposal is a function of the seed and of the trials before it, whichever process made those. Axes that are circles (azimuths)
have no ends: TPE sees them cut open opposite to the worst place so far, CMA-ES walks around them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Literal

import numpy as np

from scenes.arrays import Floats

if TYPE_CHECKING:
    import cmaes

Axis = Literal["line", "circle"]
Sampler = Literal["tpe", "cmaes"]
_SPREAD = 0.2  # CMA-ES's first standard deviation, of the cube's side
_CANDIDATES = 48  # that TPE chooses from


@dataclass(frozen=True, slots=True, eq=False)
class Tried:
    """A trial that is done: a place (dimensions,) of the unit cube, and what it cost."""

    unit: Floats
    value: float


def wrapped(unit: Floats, axes: Sequence[Axis]) -> Floats:
    """The place in the unit cube: circles modulo a turn, lines ending at their ends."""
    circles = np.array([axis == "circle" for axis in axes])
    return np.asarray(np.where(circles, unit % 1.0, np.clip(unit, 0.0, 1.0)))


def proposed(sampler: Sampler, axes: Sequence[Axis], tried: Sequence[Tried], startup: int, seed: int) -> Floats:
    """(dimensions,) the next place to be tried; the first ``startup`` ones are spread evenly."""
    if len(tried) < startup:
        return np.asarray(evenly(len(axes), startup, seed)[len(tried)])
    return _by_tpe(axes, tried, seed) if sampler == "tpe" else _by_cmaes(axes, tried, startup, seed)


@cache
def evenly(dimensions: int, count: int, seed: int) -> Floats:
    """(≥ count, dimensions) a scrambled Sobol sequence (Owen 1998), whose beginning does not hang on ``count``."""
    from scipy.stats.qmc import Sobol

    bits = max(count - 1, 1).bit_length()
    return np.asarray(Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed)).random_base2(bits))


def _by_tpe(axes: Sequence[Axis], tried: Sequence[Tried], seed: int) -> Floats:
    """Multivariate tree-structured Parzen estimator (Bergstra et al. 2011; Falkner et al. 2018) of all trials so far."""
    import optuna

    circles = np.array([axis == "circle" for axis in axes])
    worst = max(tried, key=lambda one: one.value).unit
    turn = np.where(circles, 0.5 - worst, 0.0)
    names = [f"u{axis}" for axis in range(len(axes))]
    space: dict[str, optuna.distributions.BaseDistribution] = {
        name: optuna.distributions.FloatDistribution(0.0, 1.0) for name in names
    }
    sampler = optuna.samplers.TPESampler(
        seed=_drawn(seed, len(tried)), multivariate=True, n_startup_trials=1, n_ei_candidates=_CANDIDATES
    )
    study = optuna.create_study(direction="maximize", sampler=sampler)
    for one in tried:
        places = wrapped(one.unit + turn, axes).tolist()
        study.add_trial(optuna.trial.create_trial(params=dict(zip(names, places)), distributions=space, value=one.value))
    asked = study.ask(space).params
    return np.array([asked[name] for name in names]) - turn


def _by_cmaes(axes: Sequence[Axis], tried: Sequence[Tried], startup: int, seed: int) -> Floats:
    """CMA-ES (Hansen 2016) from the worst of the first places, told again all that it asked since.

    Where it has come to rest it begins anew at a place drawn at random.
    """
    first = max(tried[:startup], key=lambda one: one.value).unit
    found, starts = _started(axes, first, _drawn(seed, 0)), 0
    asked: list[tuple[Floats, float]] = []
    for one in tried[startup:]:
        asked.append((found.ask(), -one.value))
        if len(asked) < found.population_size:
            continue
        found.tell(asked)
        asked = []
        if found.should_stop():
            starts += 1
            drawn = _drawn(seed, starts)
            found = _started(axes, np.random.default_rng(drawn).uniform(size=len(axes)), drawn)
    return np.asarray(found.ask())


def _started(axes: Sequence[Axis], mean: Floats, seed: int) -> "cmaes.CMA":
    import cmaes

    ends = np.array([(-np.inf, np.inf) if axis == "circle" else (0.0, 1.0) for axis in axes])
    return cmaes.CMA(mean=np.asarray(mean), sigma=_SPREAD, bounds=ends, seed=seed)


def _drawn(seed: int, number: int) -> int:
    """A seed that no other pair of numbers has."""
    return int(np.random.SeedSequence([seed, number]).generate_state(1)[0])
