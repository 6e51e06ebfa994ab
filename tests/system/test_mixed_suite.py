"""One data set for a camera, a rig and a LIDAR: every method answers its own sensor, and what the others saw changes nothing."""

from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from benchmark import bench, results
from benchmark.knowledge import declare
from benchmark.pool import pool
from benchmark.suite import load_suite
from estimators import registry
from scenes.dataset import Dataset
from scenes.recording import Observation

SUITE = """
title = "mixed"
description = "two frames"
quality = "draft"
[methods.mono]
estimator = "mono-rectangle"
modality = "mono"
parameters = { rate_prior_deg_s = 4.0, max_scale_px = 0.2 }
[methods.stereo]
estimator = "stereo-ring"
modality = "stereo"
[methods.lidar]
estimator = "lidar-ekf"
modality = "lidar"
model = true
[[cases]]
name = "all"
frames = "0:2"
features = ["panel", "ring"]
lidar = "lidar"
scenario.base = "standard-earthshine"
scenario.motion.position_m = [0.0, 0.0, 10.0]
"""
SENSORS = {"mono": "nav", "stereo": "stereo-left", "lidar": "lidar"}
SUBJECTS = {"mono": "panel", "stereo": "ring", "lidar": "lidar"}

pytestmark = pytest.mark.slow  # loads everything: the renderer, three cameras, all three estimators


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bench of all three modalities."""
    folder = tmp_path_factory.mktemp("mixed")
    (folder / "mixed.toml").write_text(SUITE, encoding="utf-8")
    bench.bench(load_suite(str(folder / "mixed.toml")), folder / "out", in_process=True)
    return folder / "out"


def test_each_method_answers_its_subject_by_its_sensor(done: Path) -> None:
    frames = pool(done, results.read(done))
    found = {(row.method, row.modality, row.sensor, row.subject) for row in frames.itertuples()}
    assert found == {(name, name, SENSORS[name], SUBJECTS[name]) for name in SENSORS}
    assert frames.groupby("method").size().tolist() == [2, 2, 2]
    assert frames["answered"].all()
    assert frames["geodesic_deg"].max() < 2.0


@pytest.mark.parametrize("method", list(SENSORS))
def test_what_other_sensors_saw_changes_nothing(done: Path, method: str) -> None:
    dataset = Dataset.open(done / "datasets" / "all")
    lidar = "lidar" if method == "lidar" else None
    knowledge = declare(dataset, None if lidar else SUBJECTS[method], lidar=lidar, grant_model=lidar is not None).knowledge
    seen = dataset.observation(0)
    own = [name for name in seen.images if name.startswith(SENSORS[method].removesuffix("-left"))]
    alone = replace(
        seen,
        images=MappingProxyType({name: seen.images[name] for name in own}),
        scans=MappingProxyType({name: seen.scans[name] for name in seen.scans if lidar}),
    )
    assert len(alone.images) + len(alone.scans) < len(seen.images) + len(seen.scans)
    assert np.array_equal(_answer(method, knowledge, seen), _answer(method, knowledge, alone))


def _answer(method: str, knowledge: object, observation: Observation) -> np.ndarray:
    names = {"mono": "mono-rectangle", "stereo": "stereo-ring", "lidar": "lidar-ekf"}
    one = registry.load(names[method], **({"max_scale_px": 0.2} if method == "mono" else {}))
    one.start(knowledge)  # type: ignore[arg-type]
    estimate = one.step(observation)
    assert estimate.sensor == SENSORS[method]
    assert estimate.sensor_from_target is not None
    return np.asarray(estimate.sensor_from_target.as_quat())
