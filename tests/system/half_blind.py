"""Outside methods that always know the attitude; one of them answers nothing where the picture is brighter left than right."""

from collections.abc import Sequence

from scipy.spatial.transform import Rotation

from estimators.api import Estimate, Outcome
from scenes.recording import Knowledge, Observation


class AllSeeing:
    """It is given the answer."""

    def __init__(self, attitude_xyzw: Sequence[float]) -> None:
        self.answer = Rotation.from_quat(attitude_xyzw)

    def start(self, knowledge: Knowledge) -> None:
        self.sensor = next(iter(knowledge.sensors))

    def step(self, observation: Observation) -> Estimate:
        return Estimate(self.sensor, Outcome.OK, self.answer)


class HalfBlind(AllSeeing):
    """It cannot see the light, but its weakness hangs on where that stands."""

    def step(self, observation: Observation) -> Estimate:
        pixels = observation.images[self.sensor].pixels
        middle = pixels.shape[1] // 2
        if pixels[:, :middle].mean() > 1.02 * pixels[:, middle:].mean():
            return Estimate(self.sensor, Outcome.NO_FEATURES, reason="brighter left")
        return super().step(observation)
