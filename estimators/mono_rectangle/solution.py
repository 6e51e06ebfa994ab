"""Four measured lines → one attitude with its covariance, or the reason why these lines are no rectangle."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.mono_rectangle.accuracy import closed_form_sensitivity, fit_sensitivity, vertex_covariance_px
from estimators.mono_rectangle.closed_form import aspect_ratio, homogeneous, is_possible, raw_rotation
from estimators.mono_rectangle.edge_refit import EdgeFit
from estimators.mono_rectangle.parameters import TrackedParameters
from estimators.mono_rectangle.projection import project_to_so3
from estimators.mono_rectangle.quadrilateral import intersections, normalised_from_ideal
from estimators.mono_rectangle.rectangle_fit import RectanglePose, closed_form_pose, fit_rectangle, vertex_residual
from scenes.arrays import Floats
from scenes.intrinsics import Intrinsics


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """One frame's attitude. ``rotation`` camera from feature; ``covariance`` (3, 3) rad² of its rotation vector in camera
    axes; ``vertices_px`` (4, 2) ideal px; ``skew`` r2·r3."""

    rotation: Rotation
    covariance: Floats
    vertices_px: Floats
    log_aspect: float
    log_aspect_sigma: float
    skew: float
    skew_sigma: float


def solve(
    fits: list[EdgeFit], intrinsics: Intrinsics, parameters: TrackedParameters, aspect: float | None, expected: Rotation | None
) -> Solution | str:
    """The attitude from four fitted edges; a sentence where they form no rectangle seen from outside.

    ``aspect`` = L/W if it is granted; ``expected`` chooses between the two tilts that a known aspect leaves.
    """
    vertices_px = intersections(np.array([fit.ends_px for fit in fits]))
    vertices = normalised_from_ideal(vertices_px, intrinsics)
    if not is_possible(vertices):
        return "the four lines are no rectangle seen from outside"
    if shortest := _too_short(vertices_px, parameters.min_side_px):
        return shortest
    spread, slopes = _vertex_spread(fits, intrinsics, parameters.systematic_sigma_px), closed_form_sensitivity(vertices)
    raw = raw_rotation(vertices)
    rotation, sensitivity = project_to_so3(raw, parameters.projection), slopes.rotation
    if parameters.solution == "fit" or aspect is not None:
        pose = _fitted(vertices, aspect, expected)
        rotation, sensitivity = pose.rotation, fit_sensitivity(pose, known_aspect=aspect is not None)
    found = Solution(
        rotation=Rotation.from_matrix(rotation),
        covariance=_with_second_order(sensitivity @ spread @ sensitivity.T),
        vertices_px=vertices_px,
        log_aspect=float(np.log(aspect_ratio(vertices))),
        log_aspect_sigma=float(np.sqrt(slopes.log_aspect @ spread @ slopes.log_aspect)),
        skew=float(raw[:, 1] @ raw[:, 2]),
        skew_sigma=float(np.sqrt(slopes.skew @ spread @ slopes.skew)),
    )
    return _gated(found, vertices, parameters)


def _vertex_spread(fits: list[EdgeFit], intrinsics: Intrinsics, systematic_px: float) -> Floats:
    """Covariance (8, 8) of the normalised vertices; ``systematic_px`` does not average out along an edge."""
    floor = systematic_px**2 * np.eye(2)
    spread_px = vertex_covariance_px(np.array([fit.normal for fit in fits]), np.array([fit.covariance + floor for fit in fits]))
    focal = np.tile([intrinsics.fx_px, intrinsics.fy_px], 4)
    return np.asarray(spread_px / np.outer(focal, focal))


def view_angle(rotation: Rotation, vertices: Floats) -> float:
    """Angle, rad, between the outward normal and the direction back to the camera, of normalised vertices (4, 2)."""
    ray = homogeneous(vertices).mean(axis=0)
    return float(np.arccos(np.clip(-rotation.as_matrix()[:, 0] @ ray / np.linalg.norm(ray), -1, 1)))


def _gated(found: Solution, vertices: Floats, parameters: TrackedParameters) -> Solution | str:
    angle, worst = np.rad2deg(view_angle(found.rotation, vertices)), np.rad2deg(np.sqrt(np.linalg.eigvalsh(found.covariance)[-1]))
    if angle > parameters.max_view_angle_deg:
        return f"it is seen at {angle:.0f} deg, nearly edge-on (above {parameters.max_view_angle_deg:.0f} deg)"
    if worst > parameters.max_sigma_deg:
        return f"its attitude is uncertain by {worst:.1f} deg, above {parameters.max_sigma_deg:.1f} deg"
    if abs(found.skew) > parameters.gate_sigmas * found.skew_sigma:
        return f"its sides are not at right angles: r2.r3 = {found.skew:.3f}, {abs(found.skew) / found.skew_sigma:.1f} sigma"
    return found


def _fitted(vertices: Floats, aspect: float | None, expected: Rotation | None) -> RectanglePose:
    """The least-squares rectangle; with a known aspect, of its two tilts the expected one, else the better one."""
    start = closed_form_pose(vertices)
    if aspect is None:
        return fit_rectangle(vertices, start)
    both = [fit_rectangle(vertices, begin, aspect) for begin in (start, _tilted_back(start, vertices))]
    if expected is None:
        return min(both, key=lambda pose: float(vertex_residual(pose, vertices)))
    return min(both, key=lambda pose: float((expected.inv() * Rotation.from_matrix(pose.rotation)).magnitude()))


def _tilted_back(pose: RectanglePose, vertices: Floats) -> RectanglePose:
    """The bas-relief twin: the normal mirrored about the line of sight, the picture nearly the same."""
    ray = homogeneous(vertices).mean(axis=0)
    ray = ray / np.linalg.norm(ray)
    normal = pose.rotation[:, 0]
    mirrored = 2 * (normal @ ray) * ray - normal
    axis = np.cross(normal, mirrored)
    length = float(np.linalg.norm(axis))
    if length < 1e-9:
        return pose
    turn = Rotation.from_rotvec(axis / length * np.arctan2(length, float(normal @ mirrored)))
    return RectanglePose(turn.as_matrix() @ pose.rotation, pose.first, pose.log_length, pose.log_width)


def _too_short(vertices_px: Floats, least_px: float) -> str:
    sides_px = [float(np.linalg.norm(vertices_px[j] - vertices_px[i])) for i, j in ((0, 1), (2, 3), (0, 2), (1, 3))]
    shortest = min(sides_px)
    return f"its shortest side of {shortest:.1f} px is below {least_px:.1f} px" if shortest < least_px else ""


def _with_second_order(covariance: Floats) -> Floats:
    """Covariance (3, 3) rad² with what its linearisation leaves out: two tilts of 1σ turn the roll by σ²."""
    worst = float(np.linalg.eigvalsh(covariance)[-1])
    return np.asarray(covariance + worst**2 * np.eye(3))
