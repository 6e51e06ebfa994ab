"""Tables in a terminal: names give way first and break at their hyphens; a number is never cut while a name could give way."""

import re

import pytest
from rich.console import Console

from benchmark.console_table import fitted, table
from benchmark.leaderboard import cells
from benchmark.ring_summary import FrameToFrame, RingSummary, Spread
from benchmark.summary import Summary

METHODS = ("stereo-ring-paper", "stereo-ring-paper-12dn", "stereo-ring", "stereo-ring-filtered")


def _printed(rows: list[dict[str, str]], width: int, title: str = "", left: bool = False) -> list[str]:
    console = Console(width=width, markup=False, emoji=False)
    with console.capture() as captured:
        console.print(table(title, rows, (), left, width))
    return captured.get().splitlines()


def _words(lines: list[str]) -> set[str]:
    return {word for line in lines for word in line.split()}


def _rings() -> list[dict[str, str]]:
    """The widest figures that the suites have."""
    figure = {"value": 27.73, "low": 0.0, "high": 99.0}
    bias, sd = ({"value": value, "low": value, "high": value} for value in (-208.1, 116.8))
    spread = Spread(position_cm=(1, 1, 13.8), rotation_deg=(1, 1, 1))
    ring = RingSummary.model_validate(
        {"bias_mm": (bias,) * 3, "sd_mm": (sd,) * 3, "normal_median_deg": figure, "normal_p95_deg": figure, "ring_judged": 186}
        | {"about_normal_median_deg": figure, "ring_right": 186}
        | {"frame_to_frame": FrameToFrame(pairs=9, answer=spread, target=spread, difference=spread)}
    )
    told = {"answered": 186, "frames": 186, "wrong": 186, "cpu_s_per_frame": 0.4556, "label_switches": 42, "ring": ring}
    each = [Summary.model_construct(title=name, **told) for name in METHODS]
    return [{"case\nfeature": "terminator-near-seed0\nring", **cells(one)} for one in each]


@pytest.mark.parametrize("width", [100, 120])
def test_rings_fit_without_a_broken_word(width: int) -> None:
    rows = _rings()
    lines = _printed(rows, width)
    assert max(map(len, lines)) <= width
    whole = {word for row in rows for cell in row.values() for word in re.split(r"(?<=[a-z]-)|\s", cell) if word}
    pieces = {piece for word in _words(lines) for piece in re.split(r"(?<=[a-z]-)", word) if piece}
    assert whole <= pieces
    assert ("-208.1 -208.1 -208.1" in "\n".join(lines)) is (width == 120)  # at 100 they stand below each other


def test_rings_are_whole_names_where_there_is_room() -> None:
    assert set(METHODS) <= _words(_printed(_rings(), 160))


def test_names_give_way_before_numbers_and_the_widest_first() -> None:
    assert fitted([(5, 20), (5, 12), (8, 8)], [True, True, False], 50) == [20, 12, 8]
    assert fitted([(5, 20), (5, 12), (8, 8)], [True, True, False], 36) == [16, 12, 8]
    assert fitted([(5, 20), (5, 12), (3, 8)], [True, True, False], 18) == [5, 5, 8]
    assert fitted([(5, 20), (5, 12), (3, 8)], [True, True, False], 14) == [5, 5, 4]
    assert fitted([(5, 20)], [True], 1) == [5]  # what is left is the terminal's to fold


def test_an_exponent_is_no_hyphen() -> None:
    rows = [{"method": "lidar-ekf-paper-first-scan", "noise, 1σ": "9.9e-05", "frames": "10000/10000"}]
    assert {"9.9e-05", "10000/"} <= _words(_printed(rows, 30))


def test_a_word_among_figures_stands_where_figures_stand() -> None:
    lines = _printed([{"method": "mine", "score": "1605", "breaks": "68.59"}, {"method": "a", "score": "1", "breaks": "never"}], 80)
    assert lines[-3].rstrip().endswith("  68.59")
    assert len(lines[-3].rstrip()) == len(lines[-2].rstrip())
    assert lines[-2].startswith("  a ")


def test_a_heading_is_no_wider_than_its_column() -> None:
    lines = _printed([{"method": "a", "frame to frame z cm": "0.0035"}], 100)
    assert [line.split() for line in lines if line.strip()][:4] == [["frame"], ["to"], ["frame"], ["method", "z", "cm"]]


def test_texts_keep_their_headings_and_hyphens() -> None:
    lines = _printed([{"": "backend", "to do": "apt-get install libllvm19"}], 24, left=True)
    assert "to do" in "\n".join(lines)
    assert "apt-get" in _words(lines)


def test_a_foreign_name_is_letters_and_steers_nothing() -> None:
    name = "[red]:rocket: \x1b[31mmine"
    lines = _printed([{"method": name, "wrong": "3"}, {"method": "漢字" * 30, "wrong": "4"}], 40)
    assert "[red]:rocket:" in _words(lines)
    assert not any("\x1b" in line for line in lines)
    assert any("漢字" in line for line in lines)
