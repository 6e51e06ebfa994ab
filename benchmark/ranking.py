"""Who is better, and whether that is sure: rankings of methods by one published rule, from every judged frame.

The rule's numbers stand in ``benchmark.ranking_rule``, the bootstrap in ``benchmark.ranking_bootstrap``.
"""

from pathlib import Path
from typing import get_args

import pandas as pd

from benchmark.files import publish, read_record
from benchmark.ranking_division import division
from benchmark.ranking_record import Difference, Division, Estimate, Ranking, Rule, Standing
from benchmark.ranking_rule import charges
from benchmark.ranking_table import divided
from benchmark.subjects import Modality

__all__ = ["FILE", "Difference", "Division", "Estimate", "Ranking", "Rule", "Standing", "charges", "ranking", "read", "write"]

FILE = "ranking.json"


def ranking(frames: pd.DataFrame) -> Ranking:
    """Ranks the methods of ``frames``, rows of ``benchmark.pool.pool`` in any order, by their titles.

    Only methods that answered the same pictures are compared: a division is all tracks of a modality that the same set of methods
    answered. The same rows give the same bits.
    """
    kinds = get_args(Modality)
    divisions = [division(part) for part in divided(frames)]
    methods = {id(one): sorted(standing.method for standing in one.methods) for one in divisions}
    divisions.sort(key=lambda one: (kinds.index(one.modality), -one.frames, methods[id(one)]))
    return Ranking(divisions=tuple(divisions))


def write(folder: Path, found: Ranking) -> None:
    """Writes ranking.json."""
    publish(folder, {FILE: (found.model_dump_json(indent=2) + "\n").encode()})


def read(folder: Path) -> Ranking:
    """The ranking in ``folder``. Raises ``PredictionsError`` where there is none or it is not one."""
    return read_record(folder, FILE, Ranking, "run hardlight bench or judge again")
