"""Two frames that tell: where the light left enough to know the pose and a method failed, and where nobody could have known."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from benchmark.gallery_answers import Answers
from benchmark.gallery_cameras import camera_views
from benchmark.gallery_item import View, conditions, verdict
from benchmark.ranking_cells import short
from benchmark.study.outcomes import Outcomes
from benchmark.subjects import NAMES

_GOOD, _POOR = 1 / 3, 0.9  # of the frames' bounds: up to which quantile one is good, from which on poor


@dataclass(frozen=True, slots=True, eq=False)
class Telling:
    """One frame of one method; ``heading`` says what it shows, ``verdict`` what came out."""

    heading: str
    method: str
    label: str
    link: str
    verdict: str
    conditions: str
    bound: str
    views: tuple[View, ...]


def telling(folder: Path, found: Outcomes) -> Iterator[Telling]:
    """Of each modality with bounds, the worst failure under a good bound, and the frame with the poorest bound."""
    answers = Answers(folder)
    for modality in NAMES:
        frames = found.frames[(found.frames["modality"] == modality) & found.frames["bound_asked"]]
        for heading, row in _chosen(frames, NAMES[modality]):
            if (folder / str(row["dataset"]) / "frames").is_dir():
                yield _told(answers, found, heading, row)


def _chosen(frames: pd.DataFrame, name: str) -> Iterator[tuple[str, pd.Series]]:
    sigma = frames["bound_rotation_rad"].astype(np.float64)
    known = sigma.dropna()
    if known.empty:
        return
    failed = frames[~frames["right"] & (sigma <= known.quantile(_GOOD))]
    if len(failed):
        lost = failed.sort_values(["charge", "bound_rotation_rad"], ascending=[False, True], kind="stable")
        yield f"{name}: the light was good, the method failed", lost.iloc[0]
    poor = frames[sigma.isna() | (sigma >= known.quantile(_POOR))]
    poor = poor.assign(order=sigma.fillna(np.inf)).sort_values(["order", "charge"], ascending=False, kind="stable")
    yield f"{name}: nobody could have known", poor.iloc[0]


def _told(answers: Answers, found: Outcomes, heading: str, row: pd.Series) -> Telling:
    labels = found.points.drop_duplicates("point").set_index("point")["label"]
    sigma = row["bound_rotation_rad"]
    known = found.frames.loc[found.frames["modality"] == row["modality"], "bound_rotation_rad"].dropna()
    share = f"; {np.mean(known < sigma):.0%} of the frames have a better one" if np.isfinite(sigma) else ""
    bound = f"σ {short(float(np.degrees(sigma)))}°{share}" if np.isfinite(sigma) else "undetermined: what was seen does not say it"
    views = camera_views(answers, row, answers.of(row)) if row["modality"] != "lidar" else ()
    return Telling(
        heading=heading,
        method=str(row["method"]),
        label=str(labels[row["point"]]),
        link=f"point-{row['point']}",
        verdict=verdict(row),
        conditions=conditions(row),
        bound=bound,
        views=views,
    )
