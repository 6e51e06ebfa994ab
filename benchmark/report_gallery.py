"""The page's gallery: each method's most telling frames with what lies behind them, and scans that can be turned."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from benchmark.errors import PredictionsError
from benchmark.gallery_answers import Answers
from benchmark.gallery_choice import Choice, choose
from benchmark.gallery_command import command
from benchmark.gallery_item import Item, item
from benchmark.gallery_scans import Scan3D, choose_scans, scans_3d
from benchmark.gallery_views import views_of
from benchmark.report_lidar_pictures import LEGEND
from benchmark.results import Results
from benchmark.subjects import NAMES
from scenes.errors import DatasetError

MOST_BYTES = 2_900_000  # of pictures and lines; the scans come to some 0.4 MB more


@dataclass(frozen=True, slots=True, eq=False)
class Shelf:
    """The cards of one modality, a method's beside each other."""

    key: str
    name: str
    items: tuple[Item, ...]

    @property
    def is_paired(self) -> bool:
        """Whether cards have two views."""
        return any(len(item.views) > 1 for item in self.items)


@dataclass(frozen=True, slots=True, eq=False)
class Gallery:
    """What the section shows; false where it has nothing to show. ``missing``: chosen frames whose data set is not there."""

    shelves: tuple[Shelf, ...] = ()
    scans: tuple[Scan3D, ...] = ()
    missing: int = 0

    @property
    def kinds(self) -> dict[str, str]:
        """The kinds of lines and what they show."""
        return {"true": "true outline", "answered": "answered outline", "detected": "what the method found"}

    @property
    def shared(self) -> dict[str, list[str]]:
        """What the script of the scans needs once."""
        return {"fates": [name for name, _ in LEGEND]}

    def __bool__(self) -> bool:
        """Whether there is anything."""
        return bool(self.shelves or self.scans)


def gallery(folder: Path, index: Results, frames: pd.DataFrame, titles: Sequence[str]) -> Gallery:
    """The gallery of the results in ``folder``, whose pooled table is ``frames``; a method's place in ``titles`` is its colour.

    Reads the data sets' chosen frames alone. A frame that is not there, or is damaged, is left out and counted.
    """
    answers, order = Answers(folder), list(dict.fromkeys([*titles, *frames["method"]]))
    bases = {case.name: case.base or case.name for case in index.cases}
    chosen = choose(frames, order)
    cards = [_card(choice, number, answers, order, bases) for number, choice in enumerate(chosen)]
    kept = list(_within_budget(card for card in cards if card is not None))
    shelves = tuple(_shelves(kept, order))
    scans = tuple(scans_3d(choose_scans(frames, answers), answers, order, bases))
    return Gallery(shelves, scans, missing=sum(card is None for card in cards))


def _card(choice: Choice, number: int, answers: Answers, order: list[str], bases: dict[str, str]) -> Item | None:
    row = choice.row
    try:
        said = answers.of(row)
        views = views_of(answers, row, said)
        line = command(answers.dataset(row).manifest, int(row["frame"]), bases.get(str(row["run"]), str(row["run"])))
    except (DatasetError, PredictionsError):
        return None
    reason = "" if row["answered"] else said.reason
    return item(choice, number, order.index(row["method"]), reason, line, views) if views else None


def _within_budget(cards: Iterator[Item]) -> Iterator[Item]:
    """The first cards that come to no more than ``MOST_BYTES``."""
    spent = 0
    for card in cards:
        spent += card.size
        if spent > MOST_BYTES:
            return
        yield card


def _shelves(cards: list[Item], order: list[str]) -> Iterator[Shelf]:
    for modality in NAMES:
        mine = sorted((card for card in cards if card.modality == modality), key=lambda card: order.index(card.method))
        if mine:
            yield Shelf(f"gallery-{modality}", NAMES[modality], tuple(mine))
