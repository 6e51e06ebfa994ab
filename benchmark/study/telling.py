"""Two frames that tell: where the light left enough to know the pose and a method failed, and where the light took the most."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmark.errors import PredictionsError
from benchmark.gallery_answers import Answers
from benchmark.gallery_item import View, conditions, verdict
from benchmark.gallery_views import views_of
from benchmark.ranking_cells import short
from benchmark.study.outcomes import Outcomes
from benchmark.subjects import NAMES
from scenes.errors import DatasetError

_GOOD, _POOR = 1 / 3, 0.9  # of the frames' bounds: up to which quantile one is good, from which on poor


@dataclass(frozen=True, slots=True, eq=False)
class Telling:
    """One frame of one method; ``heading`` says what it shows, ``verdict`` what came out, ``bound`` how well one could know."""

    heading: str
    method: str
    label: str
    link: str
    frame: int
    verdict: str
    conditions: str
    bound: str
    views: tuple[View, ...]


def telling(folder: Path, found: Outcomes) -> Iterator[Telling]:
    """Of each modality with bounds, the worst failure under a good bound, and the frame with the poorest bound."""
    answers = Answers(folder)
    for modality in NAMES:
        frames = found.frames[(found.frames["modality"] == modality) & found.frames["bound_asked"]]
        for is_light, row in _chosen(frames):
            try:
                yield _told(answers, found, frames, is_light, row)
            except (DatasetError, PredictionsError):
                continue  # data sets need not be there


def _chosen(frames: pd.DataFrame) -> Iterator[tuple[bool, pd.Series]]:
    """At most one frame where the method failed, and one where the light did, which is said with it."""
    sigma = frames["bound_rotation_rad"].astype(np.float64).fillna(np.inf)
    if not np.isfinite(sigma).any():
        return
    good, poor_from = (float(np.quantile(sigma, share, method="lower")) for share in (_GOOD, _POOR))
    failed = frames[~frames["right"] & np.isfinite(sigma) & (sigma <= good)]
    if len(failed):
        lost = failed.sort_values(["charge", "bound_rotation_rad"], ascending=[False, True], kind="stable")
        yield False, lost.iloc[0]
    poor = frames[sigma >= poor_from].assign(order=sigma).sort_values(["order", "charge"], ascending=False, kind="stable")
    yield True, poor.iloc[0]


def _told(answers: Answers, found: Outcomes, frames: pd.DataFrame, is_light: bool, row: pd.Series) -> Telling:
    labels = found.points.drop_duplicates("point").set_index("point")["label"]
    is_lost = not np.isfinite(row["bound_rotation_rad"])
    what = "the light was good, the method failed"
    if is_light:
        what = "the light left the pose undetermined" if is_lost else "the light took the most"
    said = answers.of(row)
    views = views_of(answers, row, said)
    return Telling(
        heading=f"{NAMES[row['modality']]}: {what}",
        method=str(row["method"]),
        label=str(labels[row["point"]]),
        link=f"point-{row['point']}",
        frame=int(row["frame"]),
        verdict=verdict(row) + ("" if row["answered"] or not said.reason else f" (“{said.reason}”)"),
        conditions=conditions(row),
        bound=_bound(row, frames),
        views=views,
    )


def _bound(row: pd.Series, frames: pd.DataFrame) -> str:
    """The σ of a frame's attitude, where it stands among the study's, and how many of it the answer is off."""
    sigma = float(row["bound_rotation_rad"])
    if not np.isfinite(sigma):
        return "undetermined: what was seen does not say the attitude, or noise of the rendering hides that it does"
    each = frames.drop_duplicates(["run", "sensor", "frame"])["bound_rotation_rad"].astype(np.float64)
    better, best = int((each < sigma).sum()), float(each.min())
    place = f"{_rounded(sigma / best)} times the best, better in {better} of {len(each)} frames" if better else "the best of all"
    off = f"; the answer is {_rounded(np.radians(row['geodesic_deg']) / sigma)} σ off" if row["answered"] else ""
    return f"{short(float(np.degrees(sigma)))}°, {place}{off}"


def _rounded(ratio: float) -> str:
    """Three digits, and no exponent."""
    return f"{float(f'{ratio:.3g}'):.10g}"
