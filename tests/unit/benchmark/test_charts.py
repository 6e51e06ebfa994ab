"""The page's charts from frames whose errors are known by hand."""

import re
from collections import Counter

import numpy as np
import pandas as pd
import pytest

from benchmark.chart_conditions import binned
from benchmark.chart_draws import Draws, draws_of
from benchmark.chart_frames import divisions, quantities, with_errors
from benchmark.chart_group import ChartGroup
from benchmark.chart_stats import bins, cdf, quantile
from benchmark.chart_time import course, panels
from benchmark.pool import COLUMNS
from benchmark.ranking import ranking
from benchmark.report import environment
from benchmark.report_charts import charts
from scenes.arrays import Floats

_HOSTILE = """<script>alert("1")</script> & '$x$'"""
_EVERY = 24  # frames of a track


def _track(method: str, errors_deg: Floats, modality: str = "mono", subject: str = "panel", case: str = "sweep") -> pd.DataFrame:
    """One track in the pool's columns: NaN in ``errors_deg`` (n,) is a frame without an answer."""
    count, answered = errors_deg.size, np.isfinite(errors_deg)
    steps = np.arange(count, dtype=np.float64)
    known = {
        "case": case, "run": f"{case}-seed0", "seed": 0.0, "subject": subject, "sensor": "nav", "modality": modality,
        "method": method, "frame": steps, "time_s": steps, "outcome": np.where(answered, "ok", "no_features"),
        "answered": answered, "wrong": answered & (errors_deg > 5.0), "geodesic_deg": errors_deg,
        "speed_rotation": np.radians(errors_deg), "speed_position": 0.002 * errors_deg,
        "position_error_m": np.nan if modality == "mono" else 0.01 * errors_deg,
        "cpu_s": 0.02, "range_m": 5.0 + steps, "phase_angle_deg": 30.0 + 2 * steps, "lit_fraction": 1.0, "saturated_fraction": 0.0,
    }  # fmt: skip
    return pd.DataFrame(known, index=range(count)).reindex(columns=list(COLUMNS))


def _errors(missing: int = 6) -> Floats:
    errors = np.geomspace(0.05, 20.0, _EVERY)
    errors[:missing] = np.nan
    return errors


def _all(first: str = "one") -> pd.DataFrame:
    """Two methods on one camera, on a ring and on a LIDAR."""
    parts = [
        _track(method, errors, modality, subject)
        for modality, subject in (("mono", "panel"), ("stereo", "ring"), ("lidar", "scanner"))
        for method, errors in ((first, _errors()), ("two", _errors(missing=0)), ("never", np.full(_EVERY, np.nan)))
    ]
    return pd.concat(parts, ignore_index=True)


def _page(groups: tuple[ChartGroup, ...]) -> str:
    source = '{% import "charts.html.j2" as charts %}{{ charts.section(groups) }}'
    return environment().from_string(source).render(groups=groups)


@pytest.fixture(scope="module")
def groups() -> tuple[ChartGroup, ...]:
    return charts(_all(_HOSTILE), [_HOSTILE, "two", "never"])


def test_the_distribution_ends_at_the_answered_share() -> None:
    frames = with_errors(_track("one", _errors(missing=6)))
    at, share = cdf(frames["rotation"].to_numpy())
    assert share[-1] == pytest.approx(18 / 24)
    assert share[0] == pytest.approx(1 / 24)
    assert np.all(np.diff(at) > 0)
    assert np.all(np.diff(share) > 0)


def test_a_long_distribution_keeps_its_ends() -> None:
    errors = np.concatenate([np.linspace(1.0, 2.0, 900), np.full(100, np.inf)])
    at, share = cdf(errors)
    assert at.size <= 200
    assert (at[0], at[-1]) == (1.0, 2.0)
    assert share[-1] == pytest.approx(0.9)


def test_nobody_answering_gives_an_empty_distribution() -> None:
    at, share = cdf(np.full(5, np.inf))
    assert at.size == share.size == 0


def test_a_bins_median_counts_frames_without_an_answer_as_the_largest() -> None:
    errors = np.array([1.0, 3.0, np.inf, 2.0, np.inf, np.inf, 5.0, 7.0])
    draws = Draws(np.ones((8, 5), dtype=np.uint16))
    found = binned(errors, np.array([0, 0, 0, 1, 1, 1, 2, 2]), 4, draws, np.arange(8))
    assert found.median[0] == 3.0  # of 1, 3, none
    assert found.median[1] == np.inf  # of 2, none, none
    assert found.median[2] == 6.0
    assert np.isnan(found.median[3])
    np.testing.assert_allclose(found.available[:3], [2 / 3, 1 / 3, 1.0])


def test_quantiles_bear_infinity() -> None:
    assert quantile(np.array([1.0, np.inf]), 0.5) == np.inf
    assert quantile(np.array([1.0, 2.0, 4.0, np.inf]), 0.5) == 3.0
    errors = np.array([1.0, 2.0, np.inf, np.inf, np.inf, 1.5])
    counts = np.random.default_rng(0).multinomial(6, np.full(6, 1 / 6), size=400).T.astype(np.uint16)
    low, high = Draws(counts).median_interval(errors, np.arange(6))
    assert low <= 2.0
    assert high == np.inf


def test_an_interval_is_of_what_each_draw_took_of_the_part() -> None:
    """Three frames of five, two draws by hand: 1, 1, 2 has the median 1; 2, 4 has 3; a draw of none of them says nothing."""
    counts = np.array([[9, 9, 9], [2, 0, 0], [1, 1, 0], [0, 1, 0], [9, 9, 9]], dtype=np.uint16)
    assert Draws(counts).median_interval(np.array([4.0, 1.0, 2.0]), np.array([3, 1, 2])) == (1.0, 3.0)
    low, high = Draws(counts).median_interval(np.array([1.0, 2.0]), np.array([1, 2]))
    assert np.isnan(low)
    assert np.isnan(high)


def test_a_method_has_one_interval_on_the_whole_page() -> None:
    """The overview's median and interval are the leaderboard's, whatever the rows' order and with a track too short for blocks."""
    noise = np.random.default_rng(1).lognormal(size=(3, 60))
    tracks = [_track(method, noise[row], "stereo", case=case) for row, (method, case) in enumerate((("one", "b"), ("two", "b")))]
    short = [_track(method, noise[2, :2], "stereo", case="a") for method in ("one", "two")]
    frames = pd.concat(tracks + short, ignore_index=True)
    frames = frames.sample(frac=1.0, random_state=2)
    (expected,) = ranking(frames).divisions
    ((part,), _) = divisions(with_errors(frames))
    for standing in expected.methods:
        mine = part.frames[part.frames["method"] == standing.method]
        for column, scale, told in (
            ("rotation", 1.0, standing.rotation_median_deg), ("position", 100.0, standing.position_median_share),
        ):  # fmt: skip
            assert told is not None
            low, high = part.draws.median_interval(mine[column].to_numpy(), mine["place"].to_numpy())
            assert (low, high) == pytest.approx((scale * told.low, scale * told.high))


def test_rows_of_one_frame_have_one_place() -> None:
    frames = pd.concat([_track("one", _errors()), _track("two", _errors()).iloc[::-1]], ignore_index=True)
    draws, places = draws_of(frames)
    assert draws.counts.shape == (_EVERY, 1000)
    np.testing.assert_array_equal(places, np.concatenate([np.arange(_EVERY), np.arange(_EVERY)[::-1]]))
    np.testing.assert_array_equal(draws.counts.sum(axis=0), _EVERY)


def test_bins_hold_equally_many_frames_and_none_is_empty() -> None:
    found = bins(np.append(np.arange(60.0), np.nan))
    assert found.member[-1] == -1
    counts = np.bincount(found.member[:-1])
    assert counts.sum() == 60
    assert counts.min() >= 9
    assert len(found.names) == 6
    assert found.edges is not None
    assert len(set(found.edges)) == 7


def test_few_values_have_a_bin_each() -> None:
    found = bins(np.array([30.0, 40.0, 30.0, 40.0001]))
    assert found.names == ("30", "40")
    assert found.edges is None
    assert list(found.member) == [0, 1, 0, 1]


def test_a_frame_without_an_answer_is_never_drawn_as_zero() -> None:
    """A row with an error of zero but without an answer stays infinite in every quantity and absent from every line."""
    frames = _track("one", np.zeros(3), modality="stereo").assign(answered=[True, False, False])
    errors = with_errors(frames)
    for column in ("rotation", "position"):
        np.testing.assert_array_equal(errors[column], [0.0, np.inf, np.inf])
    found = course(np.arange(3), np.arange(3.0), errors["rotation"].to_numpy())
    for line in (found.least, found.median, found.largest):
        np.testing.assert_array_equal(np.isnan(line), [False, True, True])
    np.testing.assert_array_equal(found.failing, [False, True, True])


def test_who_never_answers_has_no_median(groups: tuple[ChartGroup, ...]) -> None:
    for group in groups:
        for plot in group.plots:
            assert "never: 0 % of 24 frames answered, no median" in plot.summary
            for row in plot.rows[1:]:
                if row[0] == "never" and group.key == "mono-cdf":
                    assert row[2:] == ("0 %", "0 %", "0 %", "0 %", "–", "–")


def test_every_modality_has_its_groups(groups: tuple[ChartGroup, ...]) -> None:
    expected = [
        f"{modality}-{key}" for modality in ("mono", "stereo", "lidar") for key in ("overview", "cdf", "conditions", "time")
    ]
    assert [group.key for group in groups] == expected
    by_key = {group.key: len(group.plots) for group in groups}
    assert (by_key["mono-cdf"], by_key["lidar-cdf"]) == (1, 2)  # a rectangle of unknown size has no position
    assert by_key["mono-conditions"] == 2  # range and phase angle vary, light does not


def test_hostile_names_are_text(groups: tuple[ChartGroup, ...]) -> None:
    for group in groups:
        for plot in group.plots:
            assert "<script" not in plot.svg
            assert "&lt;script&gt;" in plot.svg
    page = _page(groups)
    assert "<script" not in page
    assert page.count("&lt;script&gt;") > len(groups)


def test_ids_are_unique_and_references_resolve(groups: tuple[ChartGroup, ...]) -> None:
    page = _page(groups)
    ids = Counter(re.findall(r'\bid="([^"]*)"', page))
    assert not [name for name, count in ids.items() if count > 1]
    used = set(re.findall(r'(?:href="|url\()#([\w-]+)', page))
    assert used
    assert used <= set(ids)


def test_equal_frames_give_equal_bytes(groups: tuple[ChartGroup, ...]) -> None:
    again = charts(_all(_HOSTILE), [_HOSTILE, "two", "never"])
    assert _page(groups) == _page(again)


def test_each_plot_has_words_and_a_table(groups: tuple[ChartGroup, ...]) -> None:
    page = _page(groups)
    plots = [plot for group in groups for plot in group.plots]
    assert page.count("<figure>") == page.count('role="img" aria-label=') == page.count("<table>") == len(plots)
    assert all(len({len(row) for row in plot.rows}) == 1 for plot in plots)


def test_methods_share_a_chart_only_on_equal_tracks() -> None:
    frames = with_errors(pd.concat([_track("one", _errors()), _track("two", _errors()), _track("one", _errors(), case="other")]))
    parts, more = divisions(frames)
    assert [(part.title, set(part.frames["method"])) for part in parts] == [("sweep", {"one", "two"}), ("other", {"one"})]
    assert more == 0
    assert [one.column for one in quantities(frames)] == ["rotation"]


def test_panels_take_every_case_first() -> None:
    frames = pd.concat([_track("one", _errors(), case=case, subject=subject) for case in ("a", "b", "c") for subject in ("p", "q")])
    shown, rest = panels(frames, most=3)
    assert list(shown) == ["a, p", "b, p", "c, p"]
    assert rest == ("a, q", "b, q", "c, q")


def test_no_frames_no_charts() -> None:
    assert charts(pd.DataFrame(columns=list(COLUMNS)), ["one"]) == ()
