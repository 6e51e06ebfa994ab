"""One course of two craft in orbit: integrated once on a fixed grid, then known at any time."""

import math
from dataclasses import dataclass, field

import numpy as np

from scenes.arrays import Floats
from scenes.orbit_motion import TumbleInOrbit
from scenes.provenance import stream
from scenes.tumble import Tumble

_BLOCK = 512  # disturbances drawn at once
_ON_GRID = 1e-9  # of a step


@dataclass(frozen=True, slots=True, eq=False)
class Realisation:
    """States of ``scenes.tumble`` at any time, for one seed.

    Grid points are computed outwards from time 0 and kept. Between two of them the state is one further step from the one nearer
    to time 0, so an answer depends on its time alone, not on what was asked before.
    """

    motion: TumbleInOrbit
    tumble: Tumble
    seed: int
    _after: list[Floats] = field(default_factory=list)
    _before: list[Floats] = field(default_factory=list)
    _blocks: dict[int, Floats] = field(default_factory=dict)

    def state(self, time_s: float) -> Floats:
        """The state (19,) at ``time_s``, also before the first frame."""
        step_s = self.motion.step_s
        cell = math.floor(time_s / step_s + _ON_GRID)
        point = cell if cell >= 0 else cell + 1
        left_s = time_s - point * step_s
        start = self._grid_point(point)
        return start if left_s == 0 else self.tumble.step(start, left_s, self._disturbance(cell))

    def _grid_point(self, point: int) -> Floats:
        """The state at ``point`` steps from time 0."""
        kept, way = (self._after, 1) if point >= 0 else (self._before, -1)
        if not kept:
            kept.append(self._start())
        while len(kept) <= abs(point):
            cell = len(kept) - 1 if way > 0 else -len(kept)
            kept.append(self.tumble.step(kept[-1], way * self.motion.step_s, self._disturbance(cell)))
        return kept[abs(point)]

    def _start(self) -> Floats:
        motion = self.motion
        target, chaser = motion.target_orbit, motion.chaser_orbit()
        attitude = np.array(motion.inertial_from_body_wxyz)
        orbits = np.stack([target, chaser], axis=1).ravel()
        return np.concatenate([orbits, attitude / np.linalg.norm(attitude), motion.omega_body_rad_s])

    def _disturbance(self, cell: int) -> Floats:
        """The accelerations (9,) held in the step from ``cell`` to ``cell`` + 1."""
        held = cell // self.motion.steps_held
        block, place = divmod(held, _BLOCK)
        if block not in self._blocks:
            self._blocks[block] = self._drawn(block)
        return np.asarray(self._blocks[block][place])

    def _drawn(self, block: int) -> Floats:
        """(blocks, 9): each kind of disturbance has its own stream, so changing one leaves the others as they were."""
        names = ("target_acceleration", "chaser_acceleration", "target_angular_acceleration")
        motion = self.motion
        densities = (
            motion.target_acceleration_psd_m2_s3,
            motion.chaser_acceleration_psd_m2_s3,
            motion.target_angular_acceleration_psd_rad2_s3,
        )
        columns = [np.zeros((_BLOCK, 3))] * 3
        for place, (name, density) in enumerate(zip(names, densities)):
            if density:
                rng = stream(self.seed, 0, f"motion.{name}.{block}")
                columns[place] = math.sqrt(density / motion.noise_hold_s) * rng.standard_normal((_BLOCK, 3))
        return np.concatenate(columns, axis=1)
