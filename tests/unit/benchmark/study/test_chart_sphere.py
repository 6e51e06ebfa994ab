"""Maps of the sphere: cells that share it, a projection that keeps areas and sides, marks that are links."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from benchmark.study.directions import equal_area, on_sphere
from benchmark.study.sphere_cells import cells
from benchmark.study.sphere_map import Mark, drawn, projected

HOSTILE = "<script>alert('x')</script>\" onclick='y'"


def _areas(directions: np.ndarray) -> np.ndarray:
    """(n,) of the cells in the map, in shares of both discs."""
    return np.array([sum(_area(half) for half in halves) for halves in cells(directions)]) / (2 * np.pi)


def _area(outline: np.ndarray) -> float:
    if not len(outline):
        return 0.0
    x, y = projected(outline).T
    return float(abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2)


@pytest.mark.parametrize("count", [24, 72, 200])
def test_cells_of_an_even_grid_share_both_discs_evenly(count: int) -> None:
    areas = _areas(equal_area(count))
    assert areas.sum() == pytest.approx(1.0, abs=2e-3)  # outlines are chords of curves
    assert areas * count == pytest.approx(np.ones(count), abs=0.08)


def test_what_was_not_studied_stays_empty() -> None:
    half = equal_area(72)[:36]
    assert _areas(half).sum() == pytest.approx(0.5, abs=0.1)
    holed = np.delete(equal_area(72), 30, axis=0)
    assert 0.985 < _areas(holed).sum() <= 1.0


def test_a_cell_is_what_no_other_direction_is_nearer_to() -> None:
    directions = np.random.default_rng(3).normal(size=(40, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for own, halves in enumerate(cells(directions)):
        for half in halves:
            nearness = half @ directions.T
            assert (nearness[:, own] >= nearness.max(axis=1, initial=-1.0) - 2e-3).all()  # chords lie a little inside


def test_a_cell_on_the_rim_has_a_part_in_each_disc() -> None:
    toward, away = cells(np.array([(1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)]))[0]
    assert len(toward)
    assert len(away)
    assert toward[:, 2].max() <= 1e-12
    assert away[:, 2].min() >= -1e-12
    front = cells(np.array([(0.0, 0.0, -1.0), (0.1, 0.0, -1.0)]))[0]
    assert len(front[0])
    assert not len(front[1])


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_directions_have_cells_too(count: int) -> None:
    areas = _areas(equal_area(count))
    assert (areas > 0.01).all()
    assert areas.sum() <= 1.0 + 1e-9


def test_the_projection_keeps_areas_and_sides() -> None:
    places = projected(on_sphere(np.random.default_rng(0).random((20_000, 2))))
    radius = np.linalg.norm(places, axis=1)
    assert radius.max() <= 1.0
    assert np.quantile(radius**2, [0.25, 0.5, 0.75]) == pytest.approx([0.25, 0.5, 0.75], abs=0.012)
    right, below, middle = projected(np.array([(0.8, 0.0, 0.6), (0.0, 0.6, -0.8), (0.0, 0.0, 1.0)]))
    assert right[0] > 0.6
    assert right[1] == 0.0
    assert below[1] > 0.4
    assert below[0] == 0.0
    assert middle.tolist() == [0.0, 0.0]
    phase_60 = projected(np.array([(np.sin(np.pi / 3), 0.0, -np.cos(np.pi / 3))]))
    assert phase_60[0, 0] == pytest.approx(np.sqrt(0.5))  # half of a hemisphere lies within 60°


def test_marks_are_links_with_names_and_what_is_not_known_is_hatched_and_crossed() -> None:
    directions = equal_area(12)
    steps = [None if place == 3 else place % 6 for place in range(12)]
    marks = [Mark(directions[place], step, step is None, HOSTILE, f"point-p{place}") for place, step in enumerate(steps)]
    svg = drawn(marks, HOSTILE)
    tree = ET.fromstring(svg)
    links = tree.findall("a")
    assert [one.get("href") for one in links] == [f"#point-p{place}" for place in range(12)]
    assert {one.get("aria-label") for one in links} == {HOSTILE}
    assert {one.get("class") for one in links[3].findall("path")} == {"none"}
    assert {one.get("class") for one in links[4].findall("path")} == {"s4"}
    assert len(tree.findall("path[@class='cross']")) == 1
    assert tree.findall(".//script") == []
    words = [one.text for one in tree.findall("text")]
    assert words.count("right") == words.count("above") == 2
    assert {"30°", "60°", "120°", "150°"} <= set(words)
