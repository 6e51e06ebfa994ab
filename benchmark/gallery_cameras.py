"""Cards of cameras: what they saw of the target, its layers, and over it the true outline, the answered one, the detections."""

from collections.abc import Iterator

import numpy as np
import pandas as pd
from scipy.spatial.transform import RigidTransform

from benchmark.gallery_answers import Answers, Said, feature_of
from benchmark.gallery_item import View
from benchmark.gallery_layers import Layer, layers, picture_uri
from benchmark.gallery_outlines import Shape, detected, feature_points, outlined, silhouette
from benchmark.gallery_window import Window, around
from benchmark.report_pictures import shown
from scenes.features import Feature
from scenes.intrinsics import Intrinsics
from scenes.solids import Solid


def camera_views(answers: Answers, row: pd.Series, said: Said) -> tuple[View, ...]:
    """The view of a camera, or of both cameras of a rig, at a pooled row's frame; the first one with all its layers."""
    dataset, frame, sensor = answers.dataset(row), int(row["frame"]), str(row["sensor"])
    feature, ring = feature_of(dataset, str(row["subject"])), answers.ring(row)
    if feature is None:
        return ()
    cameras = {"": sensor} if ring is None or not ring.views else dict(ring.views)
    truth, images = dataset.truth(frame).sensor_from_target, dataset.observation(frame).images
    given, views = said.pose(truth[sensor], np.asarray(feature.centre_m)), list[View]()
    for name, camera in cameras.items():
        here = None if given is None else truth[camera] * truth[sensor].inv() * given
        model, true = dataset.sensors[camera], truth[camera]
        lens = model.intrinsics
        window = around(lens.project(true.apply(feature_points(feature))), lens)
        shapes = list(_outlines(answers.solids(dataset), feature, {"true": true, "answered": here}, lens, window))
        if found := detected(said.extras, name, lens, window):
            shapes.append(Shape("detected", found))
        seen = Layer(
            "picture", "Picture", picture_uri(shown(window.cut(images[camera].pixels), model)), low="grey values, gamma 2.2"
        )
        more = () if views else tuple(layers(dataset.layers(frame, camera), window))
        views.append(View(name or camera, window.width, window.height, (seen, *more), tuple(shapes)))
    return tuple(views)


def _outlines(
    parts: tuple[Solid, ...], feature: Feature, poses: dict[str, RigidTransform | None], lens: Intrinsics, window: Window
) -> Iterator[Shape]:
    """The target's and the feature's outlines at the true pose and at the answered one."""
    for kind, pose in poses.items():
        if pose is None:
            continue
        if whole := silhouette(parts, pose, lens, window):
            yield Shape(f"{kind} target", whole)
        if outline := outlined(feature, pose, lens, window):
            yield Shape(kind, outline)
