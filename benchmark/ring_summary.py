"""What the scores of a method that was told of a ring come to: the block ``ring`` of summary.json."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import Field

from benchmark.figure import Figure, figure_of, mean, median, p95, sd
from benchmark.frame_motion import AXES, names
from benchmark.ring_scores import STAGE, wrong_reasons
from scenes.arrays import Floats
from scenes.spec import Fraction, Spec, Vector3

_STILL_CM, _STILL_DEG = 1e-3, 1e-3  # a target whose motion between frames varies by less than this moves uniformly
_FEWEST = 3  # frames for a slope
ThreeFigures = tuple[Figure, Figure, Figure]


class Spread(Spec):
    """Standard deviations about the mean: of a shift in the sensor frame, of a turn about the target's axes."""

    position_cm: Vector3
    rotation_deg: Vector3


class FrameToFrame(Spec):
    """How the motion from one answered frame to the next varies, over ``pairs`` pairs of successive frames.

    ``answer``: of the answered motion, the statistic of Shu et al. 2020. ``target``: of the true motion, which is what that
    statistic gives for exact answers. ``difference``: of the answered motion with the true one taken out.
    """

    pairs: int
    answer: Spread
    target: Spread
    difference: Spread

    @property
    def is_uniform(self) -> bool:
        """Whether the target moved alike between all frames, so that the paper's statistic measures noise alone."""
        return max(self.target.position_cm) < _STILL_CM and max(self.target.rotation_deg) < _STILL_DEG

    @property
    def noise(self) -> Spread:
        """What compares with the paper's figures: its own statistic for uniform motion, else the difference from the truth."""
        return self.answer if self.is_uniform else self.difference


class Drift(Spec):
    """Least-squares slopes of the errors against the frame number, per 100 frames."""

    position_mm: Vector3
    normal_deg: float
    about_normal_deg: float


class RingSummary(Spec):
    """Errors are answer minus truth over the answered frames, positions in the sensor frame.

    ``about_normal_median_deg`` and ``_max_deg`` are of the magnitude, ``_sd_deg`` is of the signed angle. ``ring_judged``: answers
    that came with the ellipses of both views; ``ring_right_fraction``: right ones among all frames, answered or not.
    ``wrong_reasons``: how many answers are wrong by their ring, attitude, position (one answer may be wrong in several ways).
    ``acquisition_cpu_s``: mean over the frames that a method marks as detected from scratch, ``tracking_cpu_s``: over its other
    answers, both with their counts.
    """

    bias_mm: ThreeFigures | None = None
    sd_mm: ThreeFigures | None = None
    normal_median_deg: Figure | None = None
    normal_p95_deg: Figure | None = None
    normal_max_deg: float | None = None
    about_normal_median_deg: Figure | None = None
    about_normal_sd_deg: Figure | None = None
    about_normal_max_deg: float | None = None
    radius_bias_mm: Figure | None = None
    radius_sd_mm: Figure | None = None
    ring_judged: int = 0
    ring_right: int = 0
    ring_right_fraction: Fraction = 0.0
    wrong_reasons: dict[str, int] = Field(default_factory=dict)
    frame_to_frame: FrameToFrame | None = None
    drift: Drift | None = None
    stage_cpu_s: dict[str, float] = Field(default_factory=dict)
    acquisition_cpu_s: float | None = None
    acquisition_frames: int = 0
    tracking_cpu_s: float | None = None
    tracking_frames: int = 0


def ring_summary(scores: pd.DataFrame) -> RingSummary:
    """The block from the score rows of one sensor, in frame order."""
    judged = scores["ring_right"].dropna()
    right = int(judged.sum())
    fields = _positions(scores) | _angles(scores) | _cpu(scores) | _radius(scores)
    fields |= {"ring_judged": len(judged), "ring_right": right, "ring_right_fraction": right / len(scores)}
    fields |= {"wrong_reasons": {reason: int(np.count_nonzero(at)) for reason, at in wrong_reasons(scores).items()}}
    fields |= {"frame_to_frame": _frame_to_frame(scores), "drift": _drift(scores)}
    return RingSummary.model_validate(fields)


def _positions(scores: pd.DataFrame) -> dict[str, object]:
    error_mm = [1e3 * _numbers(scores, f"ring_{axis}_error_m") for axis in AXES]
    if not error_mm[0].size:
        return {}
    return {"bias_mm": tuple(figure_of(one, mean) for one in error_mm), "sd_mm": tuple(figure_of(one, sd) for one in error_mm)}


def _angles(scores: pd.DataFrame) -> dict[str, object]:
    tilt, turn = _numbers(scores, "normal_error_deg"), _numbers(scores, "about_normal_error_deg")
    if not tilt.size:
        return {}
    return {
        "normal_median_deg": figure_of(tilt, median),
        "normal_p95_deg": figure_of(tilt, p95),
        "normal_max_deg": float(tilt.max()),
        "about_normal_median_deg": figure_of(np.abs(turn), median),
        "about_normal_sd_deg": figure_of(turn, sd),
        "about_normal_max_deg": float(np.abs(turn).max()),
    }


def _radius(scores: pd.DataFrame) -> dict[str, object]:
    error_mm = 1e3 * _numbers(scores, "radius_error_m")
    return {"radius_bias_mm": figure_of(error_mm, mean), "radius_sd_mm": figure_of(error_mm, sd)}


def _cpu(scores: pd.DataFrame) -> dict[str, object]:
    """Mean CPU seconds by stage, and of frames with and without a detection from scratch."""
    found = {str(name): STAGE.fullmatch(str(name)) for name in scores}
    stages = {match[1]: _numbers(scores, name) for name, match in found.items() if match is not None}
    fields: dict[str, object] = {"stage_cpu_s": {stage: float(one.mean()) for stage, one in stages.items() if one.size}}
    acquired = _acquired(scores)
    if acquired is None:
        return fields
    tracked = ~acquired & (scores["outcome"] == "ok").to_numpy()
    for kind, at in (("acquisition", acquired), ("tracking", tracked)):
        cpu_s = _numbers(scores[at], "cpu_s")
        fields |= {f"{kind}_frames": int(at.sum()), f"{kind}_cpu_s": float(cpu_s.mean()) if cpu_s.size else None}
    return fields


def _acquired(scores: pd.DataFrame) -> NDArray[np.bool_] | None:
    """Where a detection from scratch ran: as the method says, else where it spent time on a stage ``acquire``; None if unknown."""
    if "acquired" in scores and scores["acquired"].notna().any():
        return (scores["acquired"] == 1.0).to_numpy()
    return (scores["cpu_acquire_s"] > 0).to_numpy() if "cpu_acquire_s" in scores else None


def _frame_to_frame(scores: pd.DataFrame) -> FrameToFrame | None:
    """None with fewer than two pairs of successive answered frames that have positions."""
    pairs = scores[scores["step_x_m"].notna()] if "step_x_m" in scores else scores[:0]
    if len(pairs) < 2:
        return None
    return FrameToFrame(
        pairs=len(pairs),
        answer=_spread(pairs, "step"),
        target=_spread(pairs, "true_step"),
        difference=_spread(pairs, "step_error"),
    )


def _spread(pairs: pd.DataFrame, kind: str) -> Spread:
    position_m, rotation_deg = (pairs[list(group)].to_numpy(dtype=np.float64).std(axis=0, ddof=1) for group in names(kind))
    return Spread.model_validate({"position_cm": tuple(100 * position_m), "rotation_deg": tuple(rotation_deg)})


def _drift(scores: pd.DataFrame) -> Drift | None:
    columns = [f"ring_{axis}_error_m" for axis in AXES] + ["normal_error_deg", "about_normal_error_deg"]
    rows = scores.dropna(subset=columns)
    if len(rows) < _FEWEST:
        return None
    slopes = 100 * np.polyfit(rows["frame"].to_numpy(dtype=np.float64), rows[columns].to_numpy(dtype=np.float64), 1)[0]
    return Drift(position_mm=tuple(1e3 * slopes[:3]), normal_deg=slopes[3], about_normal_deg=slopes[4])


def _numbers(scores: pd.DataFrame, name: str) -> Floats:
    return scores[name].dropna().to_numpy(dtype=np.float64) if name in scores else np.empty(0)
