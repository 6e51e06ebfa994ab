"""Outcomes of studies that never ran: points and frames with the columns that scores are made from."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import pytest

from benchmark.ranking_rule import UNANSWERED_RAD
from benchmark.study.outcomes import Outcomes
from benchmark.study.record import FactorRecord, StudyRecord

Charge = Callable[[str, pd.Series, int, int], float]
"""(method, the point's row, seed, frame) → what the frame costs; a blind guess's or more is a wrong answer."""
Bound = Callable[[pd.Series, int], float]
"""(the point's row, frame) → the bound in rad; NaN where it is undetermined."""


@dataclass(frozen=True, eq=False)
class Made:
    """A study's points, from which ``outcomes`` makes what came out, given what each answer costs."""

    record: StudyRecord
    points: pd.DataFrame

    def outcomes(
        self,
        charge: Charge,
        methods: Sequence[str] = ("ours",),
        frames: int = 12,
        seeds: Sequence[float] = (np.nan,),
        bound: Bound | None = None,
        modality: str = "mono",
    ) -> Outcomes:
        rows = []
        for _, point in self.points.drop_duplicates("point").iterrows():
            for method in methods:
                for seed in seeds:
                    for frame in range(frames):
                        cost = charge(method, point, 0 if np.isnan(seed) else int(seed), frame)
                        rows.append((point["point"], seed, method, frame, cost, np.nan if bound is None else bound(point, frame)))
        table = pd.DataFrame(rows, columns=["point", "seed", "method", "frame", "charge", "bound_rotation_rad"])
        table = table.assign(case=table["point"], subject="panel", sensor="nav", modality=modality)
        right = table["charge"] < UNANSWERED_RAD
        table = table.assign(right=right, geodesic_deg=np.degrees(table["charge"]), bound_asked=bound is not None)
        return Outcomes(self.record, self.points, table.assign(bound_determined=table["bound_rotation_rad"].notna()))


@pytest.fixture
def ladder() -> Callable[..., Made]:
    """ladder(levels, baseline) → a one-at-a-time study of ``gain`` at ``levels`` and of ``idle``, which nothing hangs on."""

    def make(levels: Sequence[float] = (1, 2, 4, 8), baseline: float = 1.0, scale: str = "log", **more: Any) -> Made:
        factors = (
            FactorRecord(name="gain", title="gain", unit="×", scale=scale, baseline=baseline),
            FactorRecord(name="idle", title="idle", baseline=0.0),
        )
        rows = [("p0", "", float(baseline), 0.0)]
        rows += [(f"g{level:g}", "gain", float(level), 0.0) for level in levels if level != baseline]
        rows += [(f"i{level}", "idle", float(baseline), float(level)) for level in (1, 2)]
        points = pd.DataFrame(rows, columns=["point", "moved", "gain", "idle"]).assign(label="")
        return Made(StudyRecord(title="A ladder", design="one-at-a-time", factors=factors, **more), points)

    return make


@pytest.fixture
def crossed() -> Callable[..., Made]:
    """crossed(first, second) → a factorial study of ``gain`` and ``idle``."""

    def make(first: Sequence[float] = (1, 2, 4), second: Sequence[float] = (0, 1, 2, 3, 4, 5, 6), **more: Any) -> Made:
        factors = (FactorRecord(name="gain", title="gain", unit="m", baseline=2.0), FactorRecord(name="idle", title="idle"))
        rows = [(f"p{a:g}-{b:g}", "", float(a), float(b)) for a in first for b in second]
        points = pd.DataFrame(rows, columns=["point", "moved", "gain", "idle"]).assign(label="")
        return Made(StudyRecord(title="Crossed", design="factorial", factors=factors, **more), points)

    return make


@pytest.fixture
def sphere() -> Made:
    """A study of 49 directions of the Sun."""
    directions = np.random.default_rng(0).normal(size=(49, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = pd.DataFrame(directions, columns=["sun_x", "sun_y", "sun_z"])
    points = points.assign(point=[f"p{number:02}" for number in range(49)], moved="", label="")
    factor = FactorRecord(name="sun", title="the Sun's direction", kind="direction", dimensions=2, light="sun")
    return Made(StudyRecord(title="A sphere", design="sphere", factors=(factor,)), points)


@pytest.fixture
def hardness() -> np.ndarray:
    """(3, 200) how hard each frame of each seed is."""
    return np.random.default_rng(1).random((3, 200))
