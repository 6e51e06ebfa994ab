"""Errors of an estimated inertia that no labelling of principal axes can change, and of the ratios once they are labelled."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from benchmark.filter_states import AXES, INERTIA
from benchmark.filter_truth import TrueStates
from scenes.arrays import Floats
from scenes.inertia import components_of, inertia_of, labelled_nearest

_COMPONENTS = tuple(f"inertia_{number}" for number in range(1, 6))
_RATIOS = ("p1", "p2", "body_qw", "body_qx", "body_qy", "body_qz")
NAMES = (*INERTIA[0], "inertia_error", "p1_error", "p2_error", *(f"q_pb_{axis}_error_rad" for axis in AXES), "q_pb_error_rad")


def inertia_columns(given: pd.DataFrame, true: TrueStates) -> dict[str, Floats]:
    """The columns ``NAMES`` from a method's extras; ``inertia_error``: ‖Ĵ − J‖ / ‖J‖ (Frobenius), both of trace 3.

    A method that gives no components but the ratios p₁, p₂ and the axes, target_from_body, has its inertia made of them. The
    ratios and the axes that are judged follow from the inertia, labelled as the truth is; what a method calls them is not read.
    """
    found = np.full((len(given), len(NAMES)), np.nan)
    estimates = _estimates(given)
    for place in np.flatnonzero(np.isfinite(estimates).all(axis=1)):
        found[place] = _errors(estimates[place], true)
    return dict(zip(NAMES, found.T, strict=True))


def _estimates(given: pd.DataFrame) -> Floats:
    """(n, 5) components of the estimated inertias, NaN where there is none."""
    components = np.array(given.reindex(columns=list(_COMPONENTS)), dtype=np.float64)
    ratios = given.reindex(columns=list(_RATIOS)).to_numpy(dtype=np.float64)
    derived = np.isnan(components).any(axis=1) & np.isfinite(ratios).all(axis=1) & _has_a_trace(ratios)
    if derived.any():
        moments = np.insert(ratios[derived, :2], 0, 1.0, axis=1)
        axes = Rotation.from_quat(ratios[derived, 2:], scalar_first=True).as_matrix()
        components[derived] = components_of(np.einsum("nij,nj,nkj->nik", axes, moments, axes))
    return components


def _has_a_trace(ratios: Floats) -> NDArray[np.bool_]:
    """Whether an inertia of these ratios can be scaled to trace 3, and its axes are a rotation."""
    return np.asarray((np.abs(1.0 + ratios[:, 0] + ratios[:, 1]) > 1e-6) & (np.linalg.norm(ratios[:, 2:], axis=1) > 1e-6))


def _errors(estimate: Floats, true: TrueStates) -> Floats:
    off = estimate - true.inertia
    relative = float(np.linalg.norm(off) / np.sqrt(3.0 + true.inertia @ true.inertia))  # ‖J‖² = ‖I‖² + Σ j²
    if true.own_from_body is None:
        return np.concatenate([off, [relative], np.full(6, np.nan)])
    with np.errstate(divide="ignore", over="ignore"):
        p1, p2, own_from_body = labelled_nearest(true.principal, true.own_from_body, inertia_of(estimate))
    ratios = np.array([p1, p2]) - true.principal[1:] / true.principal[0]
    turn = (true.own_from_body.inv() * own_from_body).as_rotvec()
    return np.concatenate([off, [relative], np.where(np.isfinite(ratios), ratios, np.nan), turn, [np.linalg.norm(turn)]])
