"""How figures and intervals read in the terminal."""

import io
from contextlib import redirect_stdout

import pytest

from benchmark.console import Console
from benchmark.ranking import Division, Estimate, Ranking, Standing
from benchmark.ranking_cells import cells, figure, interval, legend, short, title


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"), (0.00001, "0.0000"), (0.00123, "0.0012"), (0.01234, "0.012"), (0.1494, "0.149"), (1.0, "1.00"), (12.34, "12.3"),
        (123.4, "123"), (2719.4, "2719"), (-1.5, "-1.50"), (3.2e7, "3e+07"), (1e100, "1e+100"),
    ],
)  # fmt: skip
def test_numbers_are_short(value: float, text: str) -> None:
    assert short(value) == text


@pytest.mark.parametrize(
    ("estimate", "value", "between"),
    [
        (Estimate(value=0.1, low=0.0881, high=0.107), "0.100", "0.088–0.107"),
        (Estimate(value=30.0, low=9.99, high=None), "30.0", "9.99–∞"),
        (Estimate(value=None, low=80.0, high=None), "—", "80.0–∞"),
        (Estimate(value=None), "—", ""),
        (Estimate(value=1.0, low=1.0, high=1.0), "1.00", ""),
        (Estimate(value=-30.0, low=-42.5, high=-16.4), "-30.0", "-42.5 to -16.4"),
        (None, "—", ""),
    ],
)
def test_an_interval_is_as_fine_as_its_upper_bound(estimate: Estimate | None, value: str, between: str) -> None:
    assert (figure(estimate), interval(estimate)) == (value, between)


def _division(modality: str = "lidar") -> Division:
    one = Estimate(value=0.02345, low=0.02111, high=0.02666)
    places = ("position_median_m", "position_p95_m", "position_median_share", "position_p95_share")
    standing = Standing(
        method="mono-rectangle-filtered", rank=1, is_tied=True, frames=100, answered=97,
        availability=Estimate(value=0.97, low=0.93, high=0.99),
        charge=one, rotation_median_deg=one, rotation_p95_deg=one, wrong=one, cpu_ms=one,
        **({} if modality == "mono" else dict.fromkeys(places, one)),
    )  # fmt: skip
    names = tuple("abcde")
    return Division(modality=modality, cases=names, subjects=("s",), tracks=1, frames=100, methods=(standing,), differences=())


def test_a_division_is_a_table_that_a_terminal_holds() -> None:
    with redirect_stdout(io.StringIO()) as printed:
        Console().table(title(_division()), cells(_division()))
    lines = [line.rstrip() for line in printed.getvalue().splitlines()]
    assert max(map(len, lines)) <= 120
    assert lines[0] == "lidar: a, b, c and 2 more (s); 1 track, 100 frames"
    assert any(line.startswith("  1= mono-rectangle-filtered") and "97.0" in line for line in lines)
    assert max(map(len, legend(Ranking()).splitlines())) <= 120


def test_a_rectangles_table_says_nothing_of_positions() -> None:
    assert any("position" in heading for heading in cells(_division())[0])
    assert not any("position" in heading for heading in cells(_division("mono"))[0])
