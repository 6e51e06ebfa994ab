"""The first pose: where a scan lies on a known surface if nothing is known beforehand.

Every direction of view and every roll about it is tried with few points: the scan against what could be seen from there, and back.
The best are registered, and judged by how near each return lies to the visible surface and each visible point to a return: a point
that should have been seen and was not speaks against a pose as much as a return where nothing is.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.lidar_filter.clouds import Surface, voxel_means
from estimators.lidar_filter.parameters import AcquisitionParameters, RegistrationParameters, VisibilityParameters
from estimators.lidar_filter.registration import register
from estimators.lidar_filter.registration_noise import Noise
from estimators.lidar_filter.visibility import across, cones, seen
from scenes.arrays import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A pose and what it costs: the mean truncated distance both ways as a share of the truncation, from 0 (fits) to 1."""

    lidar_from_own: RigidTransform
    cost: float


class Acquisition:
    """Looks for poses of scans on one surface, given in a frame of its own about its centroid."""

    def __init__(
        self,
        surface_own: Surface,
        noise: Noise,
        parameters: AcquisitionParameters,
        registration: RegistrationParameters,
        visibility: VisibilityParameters,
    ) -> None:
        """``registration``: how candidates are laid over the surface."""
        self._surface, self._noise, self._parameters = surface_own, noise, parameters
        self._registration, self._visibility = registration, visibility
        self._open: list[Candidate] = []  # poses of the last scan among which it is not decided
        self._scans = 0

    def step(self, points_lidar: Floats) -> RigidTransform | str:
        """The pose of a scan, once it is clear: where several attitudes fit, the scans that follow decide."""
        followed = [one for old in self._open if (one := self._followed(points_lidar, old)) is not None]
        self._open = self._distinct(followed) or self.candidates(points_lidar)
        self._scans = self._scans + 1 if followed else 1
        p = self._parameters
        if not self._open or self._open[0].cost > p.most_cost:
            self._open = []
            return "no attitude of the target fits the scan"
        best = self._open[0]
        self._open = [one for one in self._open if one.cost <= p.margin * best.cost]
        if len(self._open) > 1 and self._scans < p.most_scans:
            return f"{len(self._open)} attitudes of the target fit the scans so far"
        self._open = []
        return best.lidar_from_own

    def _followed(self, points_lidar: Floats, old: Candidate) -> Candidate | None:
        """A candidate in the next scan; its cost is the mean over all scans."""
        new = self.refined(points_lidar, old.lidar_from_own)
        return None if new is None else Candidate(new.lidar_from_own, old.cost + (new.cost - old.cost) / (self._scans + 1))

    def candidates(self, points_lidar: Floats) -> list[Candidate]:
        """Poses that may be right, the best first, each of another attitude; empty where there are too few returns."""
        if len(points_lidar) < self._registration.least_points:
            return []
        coarse = self._coarse(points_lidar)
        return self._distinct([one for pose in coarse if (one := self.refined(points_lidar, pose)) is not None])

    def refined(self, points_lidar: Floats, start: RigidTransform) -> Candidate | None:
        """The pose that registration comes to from ``start``, with its cost; None where it comes to nothing."""
        wide = self._registration.model_copy(update={"kind": "point-to-point", "reach_m": self._parameters.reach_m})
        pose = start
        for parameters in (wide, self._registration):
            found = register(points_lidar, self._seen(pose), pose, self._noise, parameters)
            if isinstance(found, str):
                return None
            pose = found.lidar_from_target
        return Candidate(pose, self._cost(points_lidar, pose))

    def _seen(self, lidar_from_own: RigidTransform) -> Surface:
        return self._surface.at(seen(self._surface.moved(lidar_from_own), self._visibility))

    def _cost(self, points_lidar: Floats, lidar_from_own: RigidTransform) -> float:
        visible = self._seen(lidar_from_own).moved(lidar_from_own).points
        if not len(visible):
            return 1.0
        reach = max(self._parameters.final_reach_m, 3 * self._noise.range_m)
        scan, _ = _one_a_cone(points_lidar, self._visibility.cell_m)
        surface, _ = _one_a_cone(visible, self._visibility.cell_m)
        return (_mean_distance(scan, cKDTree(visible), reach) + _mean_distance(surface, cKDTree(points_lidar), reach)) / 2

    def _distinct(self, candidates: list[Candidate]) -> list[Candidate]:
        """The cheapest of each attitude, the cheapest first."""
        kept: list[Candidate] = []
        for one in sorted(candidates, key=lambda candidate: candidate.cost):
            turns = [(one.lidar_from_own.rotation.inv() * other.lidar_from_own.rotation).magnitude() for other in kept]
            if all(np.asarray(turns) > np.deg2rad(self._parameters.apart_deg)):
                kept.append(one)
        return kept

    def _coarse(self, points_lidar: Floats) -> list[RigidTransform]:
        """The best poses among all directions and rolls."""
        parameters = self._parameters
        middle = points_lidar.mean(axis=0)
        sight_from_lidar = _to_z(middle)
        thin, _ = _one_a_cone(points_lidar, parameters.cell_m)
        scan = sight_from_lidar.apply(thin)
        centre = scan.mean(axis=0)
        scan, tree = scan - centre, cKDTree(scan - centre)
        rolls = Rotation.from_rotvec(np.arange(parameters.rolls)[:, None] * [0.0, 0.0, 2 * np.pi / parameters.rolls])
        tried: list[tuple[float, RigidTransform]] = []
        for view_from_own in directions(parameters.directions):
            visible, at = self._view(view_from_own, float(np.linalg.norm(middle)))
            if not len(visible):
                continue
            costs = _costs(scan, tree, visible, rolls, parameters.reach_m)
            for roll in np.argsort(costs, kind="stable")[:3]:
                turn = rolls[int(roll)] * view_from_own
                placed = RigidTransform.from_components(centre - rolls[int(roll)].apply(at), turn)
                tried.append((float(costs[roll]), RigidTransform.from_rotation(sight_from_lidar.inv()) * placed))
        tried.sort(key=lambda one: one[0])
        return [pose for _, pose in tried[: parameters.registered]]

    def _view(self, view_from_own: Rotation, range_m: float) -> tuple[Floats, Floats]:
        """What is seen from a direction, one point a cone, about its centroid; and where that lies from the own origin."""
        away = RigidTransform.from_components([0.0, 0.0, range_m], view_from_own)
        surface = self._surface.moved(away)
        visible = surface.points[seen(surface, self._visibility)]
        if not len(visible):
            return visible, np.zeros(3)
        thin, _ = _one_a_cone(visible, self._parameters.cell_m)
        centre = thin.mean(axis=0)
        return thin - centre, centre - [0.0, 0.0, range_m]


def _costs(scan: Floats, tree: cKDTree, visible: Floats, rolls: Rotation, reach_m: float) -> Floats:
    """Cost (rolls,) of each roll: the visible surface, turned by it, against the scan, and back."""
    turns = rolls.as_matrix()
    surface = np.einsum("rij,nj->rni", turns, visible)
    back = np.einsum("rji,nj->rni", turns, scan)
    there, _ = tree.query(surface, distance_upper_bound=reach_m)
    here, _ = cKDTree(visible).query(back, distance_upper_bound=reach_m)
    return np.asarray((np.minimum(there, reach_m).mean(axis=1) + np.minimum(here, reach_m).mean(axis=1)) / (2 * reach_m))


def _mean_distance(points: Floats, tree: cKDTree, reach_m: float) -> float:
    distance, _ = tree.query(points, distance_upper_bound=reach_m)
    return float(np.minimum(distance, reach_m).mean() / reach_m)


def _one_a_cone(points_lidar: Floats, cell_m: float) -> tuple[Floats, Floats]:
    """Mean points of the cones that hold any: even over angles, as beams are; and how many each holds."""
    cell, count = cones(points_lidar, cell_m)
    held = np.bincount(cell, minlength=count)
    _, number = np.unique(cell, return_inverse=True)
    return voxel_means(points_lidar, number, int(number.max()) + 1), held[held > 0].astype(np.float64)


def _to_z(direction: Floats) -> Rotation:
    """A rotation that turns ``direction`` to z."""
    z = direction / np.linalg.norm(direction)
    return Rotation.from_matrix(np.stack([*across(z), z]))


def directions(count: int) -> list[Rotation]:
    """Rotations that turn each of ``count`` directions, evenly spread over the sphere, to z.

    A Fibonacci lattice: Swinbank & Purser 2006, "Fibonacci grids: A novel approach to global modelling".
    """
    index = np.arange(count)
    z = 1 - (2 * index + 1) / count
    azimuth = index * np.pi * (3 - np.sqrt(5))
    flat = np.sqrt(1 - z**2)
    vectors = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), z], axis=1)
    return [_to_z(vector) for vector in vectors]
