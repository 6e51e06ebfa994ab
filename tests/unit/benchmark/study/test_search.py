"""The search against weaknesses that were put there: it finds them in its budget, finds none where none is, and survives kills."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from benchmark.study.directions import on_sphere
from benchmark.study.search import Objective, SearchRecord, search, spread
from benchmark.study.search_proposals import Sampler, evenly, proposed, wrapped
from scenes.arrays import Floats

DIRECTION = ("line", "circle")
FAILED, FINE = 2.2, 0.01
SAMPLERS: tuple[Sampler, ...] = ("tpe", "cmaes")


def octant(unit: Floats) -> float:
    """Weak where the light stands right of, below and in front of the target."""
    x, y, z = on_sphere(unit[None])[0]
    return FAILED if x > 0 and y > 0 and z < 0 else FINE


def cone(axis: tuple[float, float, float]) -> Objective:
    """Weak within 12 degrees of ``axis``, about 1 % of the sphere, towards which errors grow from a right angle on."""
    towards = np.array(axis) / np.linalg.norm(axis)

    def cost(unit: Floats) -> float:
        off_deg = np.degrees(np.arccos(np.clip(on_sphere(unit[None])[0] @ towards, -1, 1)))
        return FAILED if off_deg < 12 else FINE + 0.2 * max(0.0, 1 - off_deg / 90)

    return cost


def found(record: SearchRecord) -> bool:
    return record.tried[record.worst].value == FAILED


@pytest.mark.parametrize("sampler", SAMPLERS)
@pytest.mark.parametrize("seed", range(5))
def test_a_weakness_in_an_octant_is_found(tmp_path: Path, sampler: Sampler, seed: int) -> None:
    record = search(octant, DIRECTION, 60, seed, tmp_path / "journal", sampler)
    assert found(record)
    first = [one.value for one in record.tried].index(FAILED)
    assert record.worst == first
    assert (record.so_far == FAILED).tolist() == [place >= first for place in range(60)]
    if sampler == "tpe":  # CMA-ES may lose a plateau again, as all its places look alike
        assert np.mean([one.value == FAILED for one in record.tried]) > 2 / 8  # an eighth of the sphere: it stays where it hurts


@pytest.mark.parametrize("axis", [(0.8, 0.02, -0.6), (-0.5, 0.5, 0.7), (0.1, 0.05, 1.0)], ids=["seam", "side", "pole"])
def test_a_narrow_weakness_is_found_by_its_slope(tmp_path: Path, axis: tuple[float, float, float]) -> None:
    """Also where it straddles the seam of the azimuth. Evenly spread places alone find it in fewer of the searches."""
    assert [found(search(cone(axis), DIRECTION, 60, seed, tmp_path / f"{seed}")) for seed in range(2)] == [True, True]


def test_evenly_spread_places_miss_the_narrow_weakness_more_often() -> None:
    """The control of the above: 1.1 % of the sphere, 60 places."""
    cost = cone((0.8, 0.02, -0.6))
    hits = [max(cost(unit) for unit in evenly(2, 60, seed)[:60]) == FAILED for seed in range(40)]
    assert 0.2 < np.mean(hits) < 0.75


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_without_a_weakness_the_largest_cost_is_told(tmp_path: Path, sampler: Sampler) -> None:
    record = search(lambda unit: FINE + 0.001 * float(unit[0]), DIRECTION, 30, 1, tmp_path / "journal", sampler)
    assert not found(record)
    assert record.tried[record.worst].value == max(one.value for one in record.tried) == record.so_far[-1]
    assert record.tried[record.worst].unit[0] > 0.9


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_a_killed_search_goes_on_where_it_was_and_comes_out_the_same(tmp_path: Path, sampler: Sampler) -> None:
    whole = search(octant, DIRECTION, 30, 3, tmp_path / "whole", sampler)
    for budget in (4, 11):  # among the evenly spread ones, and after
        with pytest.raises(KeyboardInterrupt):
            search(killed_after(budget), DIRECTION, 30, 3, tmp_path / "killed", sampler)
    asked: list[Floats] = []

    def counted(unit: Floats) -> float:
        asked.append(unit)
        return octant(unit)

    again = search(counted, DIRECTION, 30, 3, tmp_path / "killed", sampler)
    assert len(asked) == 30 - 4 - 11
    assert_same(again, whole)
    assert_same(search(never, DIRECTION, 30, 3, tmp_path / "killed", sampler), whole)


def test_a_half_written_line_is_a_trial_that_was_not_done(tmp_path: Path) -> None:
    storage = tmp_path / "journal"
    whole = search(octant, DIRECTION, 12, 0, storage)
    storage.write_bytes(storage.read_bytes()[:-20])
    asked: list[Floats] = []
    again = search(lambda unit: asked.append(unit) or octant(unit), DIRECTION, 12, 0, storage)  # type: ignore[func-returns-value]
    assert len(asked) == 1
    assert_same(again, whole)


def test_a_larger_budget_goes_on_from_the_smaller_one(tmp_path: Path) -> None:
    few = search(octant, DIRECTION, 8, 0, tmp_path / "journal")
    more = search(octant, DIRECTION, 12, 0, tmp_path / "journal")
    assert [one.unit.tolist() for one in more.tried[:8]] == [one.unit.tolist() for one in few.tried]
    assert len(more.tried) == 12


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_with_a_raised_budget_every_place_still_follows_from_those_before(tmp_path: Path, sampler: Sampler) -> None:
    """CMA-ES asks again what it asked, else it would be told values of places where they were not measured."""
    for budget in (16, 32):
        record = search(bowl, DIRECTION, budget, 0, tmp_path / "journal", sampler)
    for number, one in enumerate(record.tried):
        place = wrapped(proposed(sampler, DIRECTION, record.tried[:number], record.startup, 0), DIRECTION)
        assert place == pytest.approx(one.unit, abs=1e-12)


def test_a_raised_budget_spreads_no_more_places(tmp_path: Path) -> None:
    storage = tmp_path / "journal"
    few, more = (search(octant, DIRECTION, budget, 0, storage) for budget in (8, 24))
    assert (few.startup, more.startup) == (2, 2)
    places = spread(DIRECTION, 40, 0, storage, "tpe")
    assert places.tolist() == [one.unit.tolist() for one in more.tried[:2]]
    assert search(octant, DIRECTION, 1, 0, storage).startup == 1


def test_seeds_and_samplers_are_searches_of_their_own(tmp_path: Path) -> None:
    records = [search(octant, DIRECTION, 12, seed, tmp_path / "journal", one) for seed in (0, 1) for one in SAMPLERS]
    places = [record.tried[-1].unit.tolist() for record in records]
    assert len({tuple(place) for place in places}) == 4


@pytest.mark.parametrize("sampler", SAMPLERS)
@pytest.mark.parametrize("axes", [("line",), ("circle",), ("line", "line", "circle")])
def test_every_place_lies_in_the_unit_cube(tmp_path: Path, sampler: Sampler, axes: tuple[str, ...]) -> None:
    """With the worst place in a corner, where samplers push outwards; axes that are circles are walked around."""
    record = search(lambda unit: float(np.cos(2 * np.pi * unit).sum()), axes, 40, 0, tmp_path / "journal", sampler)  # type: ignore[arg-type]
    places = np.array([one.unit for one in record.tried])
    assert places.shape == (40, len(axes))
    assert places.min() >= 0
    assert places.max() <= 1
    assert record.tried[record.worst].value > 0.95 * len(axes)


def test_a_place_without_a_value_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no value"):
        search(lambda _: float("nan"), DIRECTION, 4, 0, tmp_path / "journal")


def bowl(unit: Floats) -> float:
    """Largest, 0, at one place; the second axis may go round."""
    aside = (unit[1] - 0.62 + 0.5) % 1 - 0.5
    return -float((unit[0] - 0.31) ** 2 + aside**2)


def killed_after(trials: int) -> Callable[[Floats], float]:
    left = [trials]

    def cost(unit: Floats) -> float:
        if not left[0]:
            raise KeyboardInterrupt
        left[0] -= 1
        return octant(unit)

    return cost


def never(unit: Floats) -> float:
    raise AssertionError(f"asked at {unit}")


def assert_same(one: SearchRecord, other: SearchRecord) -> None:
    assert [(trial.unit.tolist(), trial.value) for trial in one.tried] == [
        (trial.unit.tolist(), trial.value) for trial in other.tried
    ]
