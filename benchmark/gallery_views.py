"""What a sensor saw in one frame, with the truth and the answer over it: a camera's pictures, or a LIDAR's scan."""

import pandas as pd

from benchmark.gallery_answers import Answers, Said
from benchmark.gallery_cameras import camera_views
from benchmark.gallery_item import View
from benchmark.gallery_lidars import lidar_views


def views_of(answers: Answers, row: pd.Series, said: Said) -> tuple[View, ...]:
    """The views of a pooled row's frame. Raises ``DatasetError`` where its data set is not there."""
    return (lidar_views if row["modality"] == "lidar" else camera_views)(answers, row, said)
