"""A table that a terminal holds: names give way first, at their hyphens, then several numbers in a cell, a single number last."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

_LETTERS = re.compile(r"[^\W\d_]{2}")  # no number has two in a row
_IN_NAMES = re.compile(r"(?<=[^\W\d_]{2}-)(?=\w)|(?<=\S)(?=\s)")  # behind the hyphen after a word, before a space
_IN_NUMBERS = re.compile(r"(?<=\w/)(?=\w)|(?<=\S)(?=\s)")  # 10000/10000, and several in a cell
_IN_TEXTS = re.compile(r"(?<=\S)(?=\s)")


@dataclass(frozen=True, slots=True)
class _Broken:
    """A text that breaks where ``at`` matches; where that leaves too much for a line, anywhere."""

    text: str
    at: re.Pattern[str]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        yield Text(broken(self.text, options.max_width, self.at), overflow="fold")

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(self.narrowest, _width(self.text))

    @property
    def narrowest(self) -> int:
        """Columns of its longest piece."""
        return max(cell_len(piece.strip()) for line in self.text.split("\n") for piece in self.at.split(line))


def table(title: str, rows: Sequence[Mapping[str, str]], groups: Sequence[str], left: bool, width: int) -> Table:
    """``rows`` of equal keys in ``width`` columns, as ``benchmark.console.Console.table`` says."""
    made = Table(title=title or None, title_justify="left", box=box.SIMPLE_HEAD, title_style="bold", padding=(0, 0, 0, 1))
    names: list[bool] = []
    laid = []
    for heading in rows[0]:
        cells = [_printable(row[heading]) for row in rows]
        names.append(left or (all(names) and any(map(_LETTERS.search, cells))))  # "never" in a column of figures is none
        at = _IN_TEXTS if left else _IN_NAMES if names[-1] else _IN_NUMBERS
        laid.append([_Broken(text, at) for text in (heading if left else _over(heading, cells), *cells)])
    widths = fitted(list(map(_range, laid)), names, width - 2 * len(laid) - 1)
    for (heading_cell, *_), is_name, most in zip(laid, names, widths, strict=True):
        made.add_column(heading_cell, justify="left" if is_name else "right", max_width=most)
    for index, row in enumerate(zip(*(column[1:] for column in laid), strict=True)):
        made.add_row(*row, end_section=index + 1 < len(groups) and groups[index] != groups[index + 1])
    return made


def fitted(ranges: Sequence[tuple[int, int]], names: Sequence[bool], room: int) -> list[int]:
    """Widths of columns whose contents need (least, most): the widest names give way first, then the widest numbers."""
    widths = [most for _, most in ranges]
    for kind in (True, False):
        able = [index for index, is_name in enumerate(names) if is_name is kind]
        while sum(widths) > room and (able := [index for index in able if widths[index] > ranges[index][0]]):
            widths[max(able, key=widths.__getitem__)] -= 1
    return widths


def broken(text: str, width: int, at: re.Pattern[str]) -> str:
    """``text`` with a new line before each piece that the line has no room for."""
    lines: list[str] = []
    for line in text.split("\n"):
        lines.append("")
        for piece in at.split(line):
            if lines[-1] and cell_len(lines[-1] + piece) > width:
                lines.append(piece.lstrip())
            else:
                lines[-1] += piece
    return "\n".join(lines)


def _over(heading: str, cells: Sequence[str]) -> str:
    """The heading no wider than what is below it, if its words allow."""
    if "\n" in heading:
        return heading
    return broken(heading, max(map(_width, (*heading.split(), *cells))), _IN_TEXTS)


def _range(column: Sequence[_Broken]) -> tuple[int, int]:
    return max(cell.narrowest for cell in column), max(_width(cell.text) for cell in column)


def _width(text: str) -> int:
    return max(map(cell_len, text.split("\n")))


def _printable(text: str) -> str:
    """``text`` with what would steer the terminal replaced."""
    return "".join(letter if letter.isprintable() or letter == "\n" else "\N{REPLACEMENT CHARACTER}" for letter in text)
