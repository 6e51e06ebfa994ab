"""What a LIDAR method makes of what it is told: which LIDAR it answers for, how good its returns are, and each scan as points."""

from dataclasses import dataclass

import numpy as np

from estimators.lidar_filter.chaser import at_rest, chaser_at
from estimators.lidar_filter.clouds import Returns, returns_of
from estimators.lidar_filter.registration_noise import Noise
from estimators.told import sensors_of
from scenes.recording import ChaserState, Knowledge, LidarModel, ModelCloud, Observation

_UNIFORM = 1 / np.sqrt(12)  # 1σ of a place within a beam, of the beam's width


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """One LIDAR: its name, its calibration, the noise of its returns, and the target's model where one is told."""

    name: str
    lidar: LidarModel
    noise: Noise
    model: ModelCloud | None

    def returns(self, observation: Observation) -> Returns | str:
        """What came back of the observation's scan; a sentence where there is no scan."""
        scan = observation.scans.get(self.name)
        return f"the observation holds no scan of {self.name!r}" if scan is None else returns_of(scan, self.lidar)

    def chaser(self, observation: Observation) -> tuple[ChaserState, ChaserState]:
        """The chaser now, and at the instant that the scan stands for."""
        now = observation.chaser or at_rest(observation.time_s)
        return now, chaser_at(now, observation.time_s - self.lidar.delay_s)


def setting_from(knowledge: Knowledge) -> Setting:
    """Raises ``ValueError`` where no LIDAR is told of. Of several the first is answered for."""
    if not knowledge.lidars:
        raise ValueError(f"this method registers scans of a LIDAR; there are {sensors_of(knowledge)}")
    name, lidar = next(iter(knowledge.lidars.items()))
    return Setting(name, lidar, Noise(lidar.range_sigma_m, _UNIFORM * lidar.divergence_rad), knowledge.model)
