"""Registration of one keyframe to others."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import RigidTransform

from estimators.lidar_filter.keyframe import Keyframe
from estimators.lidar_filter.parameters import MapParameters, RegistrationParameters
from estimators.lidar_filter.pose_graph import Link, information_of
from estimators.lidar_filter.registration import Registration, register
from estimators.lidar_filter.registration_noise import Noise


def linked(
    keyframes: Sequence[Keyframe],
    number: int,
    known: Sequence[int],
    new: Sequence[int],
    noise: Noise,
    parameters: MapParameters,
    registration: RegistrationParameters,
) -> list[Link]:
    """Links of keyframe ``number`` to those ``known`` to lie beside it, and to ``new`` ones where it fits them as well."""
    links: list[Link] = []
    worst_m = 0.0
    for other in known:
        found = _laid(keyframes[number], keyframes[other], noise, registration)
        if found is not None and found.overlap >= parameters.least_overlap:
            links.append(_link(keyframes, number, other, found, parameters, is_loop=False))
            worst_m = max(worst_m, found.rmse_m)
    wide = registration.model_copy(update={"kind": "point-to-point", "reach_m": parameters.loop_reach_m})
    for other in new:
        found = _laid(keyframes[number], keyframes[other], noise, wide)
        found = found and _laid(keyframes[number], keyframes[other], noise, registration, found)
        if found is not None and found.overlap >= parameters.least_overlap and found.rmse_m <= parameters.loop_rmse * worst_m:
            links.append(_link(keyframes, number, other, found, parameters, is_loop=True))
    return links


def _laid(
    one: Keyframe, other: Keyframe, noise: Noise, registration: RegistrationParameters, start: Registration | None = None
) -> Registration | None:
    """``one`` as a scan laid over ``other``, from where both are or from ``start`` on: its LIDAR from ``other``'s key."""
    averaged = Noise(noise.range_m / np.sqrt(one.returns_a_point), noise.across_rad)
    lidar_from_other = one.lidar_from_key * one.own_from_key.inv() * other.own_from_key
    begin = lidar_from_other if start is None else start.lidar_from_target
    found = register(one.lidar_from_key.apply(one.points_key), other.surface_key, begin, averaged, registration)
    return None if isinstance(found, str) else found


def _link(
    keyframes: Sequence[Keyframe], number: int, other: int, found: Registration, parameters: MapParameters, is_loop: bool
) -> Link:
    """The link that a registration makes, with what the pair's covariance leaves out."""
    onto_from_of: RigidTransform = keyframes[number].lidar_from_key.inv() * found.lidar_from_target
    floor = np.diag(np.repeat([np.deg2rad(parameters.floor_deg) ** 2, parameters.floor_m**2], 3))
    return Link(other, number, onto_from_of, information_of(found.covariance + floor, onto_from_of), is_loop)
