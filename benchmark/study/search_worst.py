"""The one frame that a search ends with: which it is, how well anybody could have known the pose, and its picture."""

from pathlib import Path

import cv2
import numpy as np
import pandas as pd
from numpy.typing import NDArray

from benchmark import bench
from benchmark.gallery_answers import Answers, feature_of
from benchmark.gallery_item import View
from benchmark.gallery_outlines import outlined, silhouette
from benchmark.gallery_views import views_of
from benchmark.gallery_window import Window
from benchmark.report_pictures import bgr, shown
from benchmark.run_bounds import bounded
from benchmark.study.outcomes import outcomes
from benchmark.study.points import Point
from benchmark.study.search_record import WorstBound
from benchmark.study.spec import Study, case_of
from scenes.dataset import Dataset

PICTURE = "worst.png"
COLOURS = {"true": "#4ade80", "answered": "#f5a524"}
_WIDE_PX = 960  # a smaller picture is enlarged, so that lines are thin beside its pixels


def costliest(frames: pd.DataFrame) -> pd.Series:
    """The row that cost most, of equal ones the farthest off; where bounds were asked for, of the frames that have one."""
    asked = frames[frames["bound_asked"].astype(bool)]
    mine = asked if len(asked) else frames
    return mine.sort_values(["charge", "geodesic_deg", "run", "frame"], ascending=[False, False, True, True], kind="stable").iloc[0]


def with_bound(study: Study, point: Point, row: pd.Series, out: Path) -> WorstBound:
    """The information limit of a row's frame, found now if it was not before."""
    run, frame = str(row["run"]), int(row["frame"])
    if not row["bound_asked"]:
        path = out / bench.DATASETS / run
        place = list(Dataset.open(path).frames).index(frame)
        case = case_of(study, point.name, point.label, point.scenario)
        bounded(path, out, run, str(place), study.bound_samples, case)
        row = same(outcomes(out).frames, row)
    rotation, position = (float(row[f"bound_{name}"]) for name in ("rotation_rad", "position_m"))
    return WorstBound(
        run=run,
        frame=frame,
        sensor=str(row["sensor"]),
        rotation_rad=rotation if np.isfinite(rotation) else None,
        position_m=position if np.isfinite(position) else None,
    )


def same(frames: pd.DataFrame, row: pd.Series) -> pd.Series:
    """The row of ``frames`` that speaks of the same answer."""
    keys = ["run", "subject", "sensor", "method", "frame"]
    return frames[(frames[keys] == row[keys]).all(axis=1)].iloc[0]


def views(folder: Path, row: pd.Series) -> tuple[View, ...]:
    """The row's frame cut out, with its outlines, as the gallery of a leaderboard shows it."""
    answers = Answers(folder)
    return views_of(answers, row, answers.of(row))


def picture(folder: Path, row: pd.Series) -> bytes:
    """A PNG: the camera's whole frame with the true outline and, if there is an answer, the answered one; a scan as it is cut."""
    if row["modality"] == "lidar":
        return _png(_decoded(views(folder, row)[0]))
    answers = Answers(folder)
    dataset, frame, sensor = answers.dataset(row), int(row["frame"]), str(row["sensor"])
    model, true = dataset.sensors[sensor], dataset.truth(frame).sensor_from_target[sensor]
    feature, lens = feature_of(dataset, str(row["subject"])), model.intrinsics
    assert feature is not None  # cameras are asked for features
    given = answers.of(row).pose(true, np.asarray(feature.centre_m))
    window = Window(0, 0, lens.width_px, lens.height_px)
    grey = shown(dataset.observation(frame).images[sensor].pixels, model)
    drawn, scale = _enlarged(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR))
    for kind, pose in (("true", true), ("answered", given)):
        if pose is not None:
            paths = silhouette(answers.solids(dataset), pose, lens, window), outlined(feature, pose, lens, window)
            _draw(drawn, " ".join(paths), scale, COLOURS[kind])
    return _png(drawn)


def _decoded(view: View) -> NDArray[np.uint8]:
    """A view's first layer with its outlines."""
    import base64

    data = np.frombuffer(base64.b64decode(view.layers[0].uri.partition(",")[2]), dtype=np.uint8)
    pixels = np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), dtype=np.uint8)
    drawn, _ = _enlarged(pixels)
    for shape in view.shapes:
        _draw(drawn, shape.path, drawn.shape[1] / view.width, COLOURS.get(shape.kind.split(" ")[0], "#7fa6ff"))
    return drawn


def _enlarged(pixels: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], float]:
    """The picture and how many times larger it is."""
    scale = max(1, -(-_WIDE_PX // pixels.shape[1]))
    return np.ascontiguousarray(pixels.repeat(scale, axis=0).repeat(scale, axis=1)), float(scale)


def _draw(pixels: NDArray[np.uint8], path: str, scale: float, colour: str) -> None:
    """An SVG path of lines, in place. SVG's (0, 0) is the corner of the first pixel, OpenCV's its centre."""
    for line in path.split("M")[1:]:
        places = np.array([pair.split(",") for pair in line.strip().rstrip("Z").split()], dtype=np.float64) * scale - 0.5
        points = np.round(places * 16).astype(np.int32)
        cv2.polylines(pixels, [points], line.strip().endswith("Z"), bgr(colour), 1, cv2.LINE_AA, 4)


def _png(pixels: NDArray[np.uint8]) -> bytes:
    return bytes(cv2.imencode(".png", pixels)[1].tobytes())
