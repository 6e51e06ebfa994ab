"""The published rule: what a frame costs a method, with an answer and without. CONVENTIONS.md tells it in words."""

import numpy as np
import pandas as pd

from benchmark.ranking_bootstrap import CONFIDENCE
from benchmark.subjects import Modality
from scenes.arrays import Floats

UNANSWERED_RAD = np.pi / 2 + 2 / np.pi
"""Mean angle of a uniformly random rotation: ∫ θ (1 − cos θ)/π dθ over 0…π, 126.5°."""
UNANSWERED_SHARE = 1.0
"""Of the range: what an answer at the sensor itself is off."""
RESAMPLES = 1000
SEED = 0
OVERFLOWN = 1e100
"""What an error counts that is too large for a float, so that sums stay numbers."""

SENTENCE = (
    "A frame without an answer is charged what a blind guess is worth, π/2 + 2/π rad in attitude and, except of a single camera's "
    "rectangle, 100 % of the range in position; an answer is charged its own SPEED score, and a wrong one at least as much as "
    "none, so that answering is never better than silence unless it is right. A method's rank is one more "
    f"than the number of methods whose mean charge is lower with the {CONFIDENCE:.0%} interval of the paired difference excluding "
    "zero; equal ranks are ties."
)


def unanswered(modality: Modality) -> float:
    """What a frame without an answer costs."""
    return float(UNANSWERED_RAD + (0.0 if modality == "mono" else UNANSWERED_SHARE))


def charges(frames: pd.DataFrame) -> Floats:
    """(n,) what each frame costs: SPEED's rotation score in rad plus, except for ``mono``, its position score in ranges.

    ``frames``: rows of ``benchmark.pool.pool``. An answer that leaves out its position is charged for that part alone; a wrong one
    as much as silence or, where it is worse, its own score: else a method that always answers something would be charged less than
    one that says when it cannot tell.
    """
    answered = frames["answered"].to_numpy(dtype=bool)
    rotation = np.where(answered, frames["speed_rotation"].to_numpy(dtype=np.float64), np.nan)
    position = np.where(answered, frames["speed_position"].to_numpy(dtype=np.float64), np.nan)
    rotation = np.nan_to_num(rotation, nan=UNANSWERED_RAD, posinf=OVERFLOWN)
    position = np.nan_to_num(position, nan=UNANSWERED_SHARE, posinf=OVERFLOWN)
    is_mono = (frames["modality"] == "mono").to_numpy()
    own = np.where(is_mono, rotation, rotation + position)
    silence = UNANSWERED_RAD + np.where(is_mono, 0.0, UNANSWERED_SHARE)
    return np.where(frames["wrong"].to_numpy(dtype=bool), np.maximum(own, silence), own)
