"""Which frames the page shows: of every method the worst answer, a frame without one, and the most wrong answer elsewhere."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Literal

import pandas as pd

from benchmark.subjects import NAMES

MOST_ITEMS = 30
Kind = Literal["worst", "unanswered", "wrong", "more"]
_PLACE = ["run", "subject", "sensor", "frame"]


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """One row of the pooled frames, and why it was chosen: ``more`` is the worst answer of a further case, if charged at all."""

    kind: Kind
    row: pd.Series


def choose(frames: pd.DataFrame, titles: Sequence[str], most: int = MOST_ITEMS) -> tuple[Choice, ...]:
    """At most ``most`` rows of the pooled ``frames``, the most telling first: every method's worst answer, then the next of each.

    Methods come by modality and by their place in ``titles``. A frame that one method did not answer is the more telling the more
    others did. Ties go to the first row, so that equal tables give equal choices.
    """
    others = frames.groupby(_PLACE, sort=False)["answered"].transform("sum") if len(frames) else None
    known = frames.assign(others=0 if others is None else others.astype(float))
    known = known.assign(score=known["score"].fillna(known["speed_rotation"]))
    order = list(dict.fromkeys([*titles, *frames["method"]]))
    methods = [known[(known["modality"] == one) & (known["method"] == title)] for one in NAMES for title in order]
    queues = [list(_queue(mine)) for mine in methods if len(mine)]
    turns = (choice for turn in zip_longest(*queues) for choice in turn if choice is not None)
    return tuple(choice for choice, _ in zip(turns, range(most)))


def _queue(mine: pd.DataFrame) -> Iterator[Choice]:
    """The choices of one method in one modality, each frame once, each further one from another case where there is one."""
    answered = mine[mine["answered"]].sort_values("score", ascending=False, kind="stable")
    by_case = answered.drop_duplicates("case").drop_duplicates(["frame", "geodesic_deg"])  # a LIDAR sees the same in any light
    if len(by_case):
        yield Choice("worst", by_case.iloc[0])
    lost = mine[~mine["answered"]].sort_values("others", ascending=False, kind="stable")
    if len(lost):
        yield Choice("unanswered", lost.iloc[0])
    elsewhere = by_case.iloc[1:]
    wrong = elsewhere[elsewhere["wrong"]]
    if len(wrong):
        yield Choice("wrong", wrong.iloc[0])
    shown = set(wrong.index[:1])
    yield from (Choice("more", row) for index, row in elsewhere.iterrows() if index not in shown and row["score"] > 0)
