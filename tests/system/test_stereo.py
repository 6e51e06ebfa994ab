"""A docking ring from scenario file to judged answer: the renderer's pictures, both methods, the judge. Draft quality."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmark import judge, run
from benchmark.knowledge import declare
from benchmark.limits import Limits
from benchmark.summary import Summary
from renderer.generate import generate
from scenes.dataset import Dataset
from scenes.scenario import load_scenario

FRAMES = range(0, 7)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Seven successive pairs under the oblique, flickering lamp."""
    from renderer.variant import probe

    if probe().is_scalar:
        pytest.skip("two pictures of four megapixels take too long ray by ray")
    folder = tmp_path_factory.mktemp("exp3")
    generate(load_scenario("shu2020-exp3"), folder / "data", frames=FRAMES, quality="draft")
    return Dataset.open(folder / "data")


def _summary(dataset: Dataset, method: str, out: Path, **parameters: object) -> Summary:
    answers = run.estimate(method, parameters, dataset, declare(dataset, "ring"), out)
    (summary,) = judge.judge(answers, dataset).summaries
    return summary


@pytest.mark.slow
def test_our_method_measures_the_ring(dataset: Dataset, tmp_path: Path):
    summary = _summary(dataset, "stereo-ring", tmp_path)
    ring = summary.ring
    assert ring is not None
    assert (summary.answered, ring.ring_right, summary.label_switches, summary.wrong) == (len(FRAMES), len(FRAMES), 0, 0)
    assert all(abs(axis.value) < 3.0 for axis in ring.bias_mm)
    assert ring.normal_median_deg.value < 0.4


@pytest.mark.slow
def test_in_a_process_of_its_own_it_answers_the_same_to_the_last_bit(dataset: Dataset, tmp_path: Path):
    tables = []
    for name, limits in (("apart", Limits()), ("here", None)):
        answers = run.estimate("stereo-ring", {}, dataset, declare(dataset, "ring"), tmp_path / name, limits=limits)
        assert answers.extras is not None
        times = [column for column in answers.extras if str(column).startswith("cpu_")]
        tables.append((answers.table.drop(columns=["cpu_s", "wall_s"]), answers.extras.drop(columns=times)))
    for apart, here in zip(*tables):
        pd.testing.assert_frame_equal(apart, here, check_exact=True)


@pytest.mark.slow
def test_the_papers_marker_threshold_and_its_largest_ellipse_fail_as_they_must(dataset: Dataset, tmp_path: Path):
    """60 DN takes markers and foil for one region; with a threshold that fits, the ring's shadow makes the larger ellipse."""
    printed = _summary(dataset, "stereo-ring-paper", tmp_path / "printed")
    assert printed.answered == 0
    fitted = _summary(dataset, "stereo-ring-paper", tmp_path / "fitted", max_grey_dn=12)
    assert fitted.answered == len(FRAMES)
    assert fitted.ring is not None
    assert fitted.ring.ring_right == 0
    assert fitted.ring.radius_bias_mm.value > 20


def test_the_manifest_holds_the_rigs_calibration(dataset: Dataset):
    (pair,) = dataset.rigs.values()
    entry = dataset.manifest.sensors[pair.left]["rig"]
    assert isinstance(entry, dict)
    fundamental = np.array(entry["fundamental_matrix"])
    truth = dataset.truth(FRAMES[0])
    marker = next(feature for feature in dataset.features if feature.name == "marker-1")
    ends = []
    for name in (pair.left, pair.right):
        point = truth.sensor_from_target[name].apply(np.array(marker.centre_m))
        ends.append(np.append(dataset.sensors[name].intrinsics.project(point), 1.0))
    line = fundamental @ ends[0]
    assert abs(line @ ends[1]) / np.hypot(*line[:2]) < 1e-6


def test_each_frame_says_where_the_lamp_stands_and_how_bright_it_is(dataset: Dataset):
    states = [dataset.state(frame)["lights"]["lamp"] for frame in FRAMES]
    assert all(state["position_chaser_m"] == pytest.approx([-4.0, -1.0, 0.0]) for state in states)
    assert all(state["irradiance_w_m2"] > 1 for state in states)
    factors = [state["power_factor"]["stereo-left"] for state in states]
    assert np.ptp(factors) > 0.01  # the mains' ripple, half of it left at 6 ms
    assert max(abs(factor - 1) for factor in factors) < 0.1 * np.sinc(0.6) + 0.01


def test_both_cameras_say_what_the_other_cannot_see(dataset: Dataset):
    for sensor in ("stereo-left", "stereo-right"):
        layers = dataset.layers(FRAMES[0], sensor)
        hidden = layers["hidden_from_partner"] > 0
        assert not hidden[layers["part_id"] == 0].any()
        assert 0.001 < hidden[layers["part_id"] > 0].mean() < 0.3
