"""Everything that a filter was told, so that it can be told again when the map has been settled anew."""

from dataclasses import dataclass

from estimators.lidar_filter.measurement import PoseFilter, PoseMeasurement
from estimators.lidar_filter.reference import Anchored, Reference
from scenes.arrays import Floats
from scenes.recording import ChaserState


@dataclass(frozen=True, slots=True, eq=False)
class Told:
    """One call of the filter: the chaser's state, and the measurement, anchored to the map; none where it was predicted."""

    chaser: ChaserState
    time_s: float = 0.0
    anchored: Anchored | None = None
    covariance: Floats | None = None


class History:
    """The calls of a filter in their order."""

    def __init__(self) -> None:
        """Nothing was told so far."""
        self._told: list[Told] = []

    def predicted(self, chaser: ChaserState) -> None:
        """Remembers a prediction."""
        self._told.append(Told(chaser))

    def measured(self, measurement: PoseMeasurement, anchored: Anchored, chaser: ChaserState) -> None:
        """Remembers a measurement."""
        self._told.append(Told(chaser, measurement.time_s, anchored, measurement.covariance))

    def tell(self, pose_filter: PoseFilter, reference: Reference) -> None:
        """Starts the filter again and tells it everything, with the poses as the map now has them."""
        is_started = False
        for told in self._told:
            if told.anchored is None or told.covariance is None:
                if is_started:
                    pose_filter.predict(told.chaser)
                continue
            measurement = PoseMeasurement(told.time_s, reference.released(told.anchored), told.covariance)
            if is_started:
                pose_filter.update(measurement, told.chaser)
            else:
                pose_filter.start(measurement, told.chaser)
                is_started = True
