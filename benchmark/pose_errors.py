"""Errors of a track of poses against the true ones, whatever feature the method was told of."""

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from benchmark import metrics, symmetry
from benchmark.angles import ANGLE_NAMES, paper_angles, wrapped
from benchmark.information.fisher import pose_error
from benchmark.predictions import positions, rotations
from scenes.arrays import Floats


def attitude_errors(
    truth: pd.DataFrame, table: pd.DataFrame, answered: np.ndarray, elements: Rotation, labels: Rotation
) -> tuple[dict[str, np.ndarray], int]:
    """Geodesic and Z-Y-X angle errors in degrees, NaN where not answered; the track's group element is divided out."""
    true = rotations(truth)
    columns = {f"{name}_deg": np.degrees(angle) for name, angle in zip(ANGLE_NAMES, paper_angles(true).T, strict=True)}
    empty = ("geodesic_deg", *(f"{name}_error_deg" for name in ANGLE_NAMES), "speed_rotation", "label")
    columns |= {name: np.full(len(truth), np.nan) for name in empty}
    if not answered.any():
        return columns, 0
    true, given = true[answered], rotations(table[answered])
    relabelled = given * elements[symmetry.track_element(true, given, elements)].inv()
    geodesic = metrics.geodesic(true, relabelled)
    columns["geodesic_deg"][answered] = np.degrees(geodesic)
    columns["speed_rotation"][answered] = metrics.speed_rotation(geodesic)
    errors = np.degrees(wrapped(paper_angles(relabelled) - paper_angles(true)))
    for name, error in zip(ANGLE_NAMES, errors.T, strict=True):
        columns[f"{name}_error_deg"][answered] = error
    columns["label"][answered] = frame_labels = symmetry.frame_labels(true, given, labels)
    return columns, symmetry.label_switches(frame_labels)


def error_vectors(
    truth: pd.DataFrame, table: pd.DataFrame, answered: np.ndarray, elements: Rotation, centre_m: Floats | None = None
) -> Floats:
    """(n, 6) turns and shifts ξ, sensor axes, that take the true poses to the answered ones; NaN where there is no answer.

    The track's group element is divided out, a turn about ``centre_m`` in the target frame (its origin where left out).
    """
    found = np.full((len(truth), 6), np.nan)
    if not answered.any():
        return found
    true, given = rotations(truth[answered]), rotations(table[answered])
    relabelled = given * elements[symmetry.track_element(true, given, elements)].inv()
    centre = np.zeros(3) if centre_m is None else np.asarray(centre_m)
    place = positions(table[answered]) + given.apply(centre) - relabelled.apply(centre)
    found[answered] = pose_error(true, positions(truth[answered]), relabelled, place)
    return found


def position_errors(true_m: Floats, given_m: Floats, speed_rotation: np.ndarray) -> dict[str, np.ndarray]:
    """Position error in metres and the SPEED scores of (n, 3) positions, NaN where a method gives no position."""
    position = metrics.speed_position(true_m, given_m)
    position[np.isnan(given_m).any(axis=1)] = np.nan
    return {
        "position_error_m": np.linalg.norm(given_m - true_m, axis=1),
        "speed_position": position,
        "speed_score": speed_rotation + position,
    }
