"""A small data set of a white rectangle that turns, drawn by OpenCV at known poses, and a toy method that finds it."""

import json
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark import judge, predictions
from benchmark.knowledge import declare
from benchmark.predictions import COLUMNS, QUATERNION
from benchmark.records import RunRecord
from benchmark.results import Entry
from benchmark.run import answer
from estimators.api import Estimate, Outcome
from scenes.dataset import Dataset
from scenes.dataset_layout import TRUTH_COLUMNS
from scenes.dataset_manifest import Manifest, calibration
from scenes.dataset_writer import DatasetWriter, FrameRecord
from scenes.features import Feature, RectangleFeature
from scenes.intrinsics import Intrinsics
from scenes.motion import AxisSweep
from scenes.pose_columns import pose_columns
from scenes.recording import Knowledge, Observation, SensorModel

SIZE = (160, 120)
SENSOR = SensorModel(Intrinsics(*SIZE, 400.0, 400.0, 79.5, 59.5), black_dn=0.0, white_dn=255.0)
PANEL = RectangleFeature(name="panel", centre_m=(0.0, 0.0, 0.0), length_m=3.0, width_m=1.5, free_standing=True)
OTHER = RectangleFeature(name="plate", centre_m=(0.0, 0.0, 0.0), length_m=1.0, width_m=1.0)


def draw(cam_from_target: RigidTransform, corners_target: np.ndarray = PANEL.corners_target) -> np.ndarray:
    """The panel as a white quadrilateral on dark grey, edges anti-aliased."""
    pixels = np.full(SIZE[::-1], 8, dtype=np.uint8)
    cyclic = SENSOR.intrinsics.project(cam_from_target.apply(corners_target))[[0, 1, 3, 2]]
    if np.isfinite(cyclic).all():
        cv2.fillConvexPoly(pixels, np.round(cyclic * 256).astype(np.int32), 200, lineType=cv2.LINE_AA, shift=8)
    return pixels


@pytest.fixture(scope="session")
def sweep() -> AxisSweep:
    return AxisSweep(type="axis-sweep", axis="y", start_deg=-20.0, rate_deg_s=2.0, range_m=12.0)


@pytest.fixture(scope="session")
def make_dataset(sweep: AxisSweep) -> Callable[..., Dataset]:
    """make_dataset(path, frames=range(21), seed=0, features=(PANEL,), motion=..., symmetry=...) → an opened data set."""

    def make(
        path: Path,
        frames: range = range(21),
        seed: int = 0,
        features: tuple[Feature, ...] = (PANEL,),
        motion: Any = None,
        symmetry: str = "d2",
    ) -> Dataset:
        motion = sweep if motion is None else motion
        target = {"symmetry": symmetry, "features": [one.model_dump() for one in features]}
        manifest = Manifest.of(
            scenario={"description": "a turning panel", "target": target, "motion": motion.model_dump()},
            seed=seed,
            frames=frames,
            sensors={"nav": calibration(SENSOR)},
            backend={"variant": "opencv"},
            quality="draft",
        )
        writer = DatasetWriter.open(path, manifest)
        for frame in frames:
            pose = motion.chaser_from_target(float(frame), frame, seed)
            truth = dict.fromkeys(TRUTH_COLUMNS, float("nan")) | pose_columns(pose) | {"range_m": 12.0, "lit_fraction": 1.0}
            layers = {"nav": {"z_m": np.zeros(SIZE[::-1], dtype=np.float32)}}
            writer.write(FrameRecord(frame, float(frame), {"nav": draw(pose)}, layers, {"nav": truth}))
        writer.finish()
        return Dataset.open(path)

    return make


@pytest.fixture(scope="session")
def dataset(make_dataset: Callable[..., Dataset], tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    return make_dataset(tmp_path_factory.mktemp("data") / "panel")


@dataclass
class ContourPnP:
    """A toy method that knows the panel's size: bright contour → 4 corners → IPPE. ``mischief`` makes it misbehave."""

    mischief: str = ""
    size_m: tuple[float, float] = (3.0, 1.5)
    last: np.ndarray = field(default_factory=lambda: np.zeros((4, 2)))
    knowledge: Knowledge | None = None

    def start(self, knowledge: Knowledge) -> None:
        if self.mischief == "start":
            raise RuntimeError("no licence")
        assert knowledge.corner_prior is not None
        self.knowledge, self.last = knowledge, np.array(knowledge.corner_prior.corners_px)

    def step(self, observation: Observation) -> Estimate:
        if self.mischief == "raise" and observation.frame == 3:
            raise ZeroDivisionError("division by zero")
        if self.mischief == "nothing" and observation.frame == 3:
            return None  # type: ignore[return-value]
        if self.mischief == "mutate":
            observation.images["nav"].pixels[:] = 0
        corners = self._corners(observation.images["nav"].pixels)
        if corners is None:
            return Estimate("nav", Outcome.NO_FEATURES, reason="no bright quadrilateral")
        self.last = corners
        return self._answer(corners)

    def _corners(self, pixels: np.ndarray) -> np.ndarray | None:
        contours, _ = cv2.findContours((pixels > 100).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        if not contours:
            return None
        found = cv2.approxPolyDP(max(contours, key=len), 8.0, True)[:, 0].astype(float)
        if len(found) != 4:
            return None
        return found[np.argmin(np.linalg.norm(self.last[:, None] - found[None], axis=2), axis=1)]

    def _answer(self, corners: np.ndarray) -> Estimate:
        assert self.knowledge is not None
        assert self.knowledge.rectangle is not None
        along, across = self.size_m[0] / 2, self.size_m[1] / 2
        in_feature = np.array([(0, a * along, b * across) for a, b in ((-1, -1), (1, -1), (-1, 1), (1, 1))])
        camera = self.knowledge.sensors["nav"].intrinsics.matrix
        _, rotation, position = cv2.solvePnP(in_feature, corners, camera, None, flags=cv2.SOLVEPNP_ITERATIVE)
        cam_from_feature = Rotation.from_rotvec(rotation.ravel())
        cam_from_target = cam_from_feature * self.knowledge.rectangle.target_from_feature.inv()
        sensor = "left" if self.mischief == "sensor" else "nav"
        return Estimate(sensor, Outcome.OK, cam_from_target, position.ravel(), extras={"corner_px": float(corners[0, 0])})


@pytest.fixture(scope="session")
def toy() -> type[ContourPnP]:
    return ContourPnP


@pytest.fixture(scope="session")
def submit() -> Callable[..., Path]:
    """submit(dataset, folder, method, turns, lost=0, cpu_s="") → the folder, with the truth turned by ``turns`` as answers.

    They are written as another program would. The last ``lost`` frames are not answered; no position is.
    """

    def write(dataset: Dataset, folder: Path, method: str, turns: Rotation, lost: int = 0, cpu_s: str = "") -> Path:
        truth = dataset.truth_table()
        rotation = Rotation.from_quat(truth[list(QUATERNION)].to_numpy(), scalar_first=True) * turns
        table = truth[["frame", "sensor"]].assign(outcome="ok", cpu_s=cpu_s, wall_s="", tx_m="", ty_m="", tz_m="")
        table[list(QUATERNION)] = rotation.as_quat(scalar_first=True, canonical=True)
        table = table[list(COLUMNS)].astype(object)
        if lost:
            table.iloc[-lost:, 2:] = ["no_features", *[""] * (len(COLUMNS) - 3)]
        folder.mkdir(parents=True)
        table.to_csv(folder / "predictions.csv", index=False)
        record = {"format": "hardlight-predictions", "version": 1, "method": method, "dataset_identity": dataset.identity}
        (folder / "run.json").write_text(json.dumps(record))
        return folder

    return write


@pytest.fixture(scope="session")
def judged_entry() -> Callable[..., Entry]:
    """judged_entry(dataset, out, folder, title, estimator, **record) → the entry of an estimator's judged answers on the panel."""

    def make(dataset: Dataset, out: Path, folder: str, title: str, estimator: Any, **record: Any) -> Entry:
        declared = declare(dataset, "panel")
        told = RunRecord(
            format="hardlight-predictions",
            version=1,
            method=title,
            dataset_identity=dataset.identity,
            knowledge=declared.record,
            **record,
        )
        answers = answer(estimator, dataset, declared.knowledge, told)
        predictions.write(out / folder, answers)
        judge.write(out / folder, judge.judge(answers, dataset))
        return Entry(case="turn", feature="panel", title=title, dataset=str(dataset.path), answers=folder, scores=folder)

    return make


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """A headless Chromium; tests that want it are skipped where there is none, or no playwright."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if chromium is None:
        pytest.skip("no Chromium here")
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as driver:
        opened = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        yield opened
        opened.close()
