"""Which pulses rise above the threshold, and what noise adds of its own."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from renderer.pulses import Pulses
from scenes.arrays import Floats
from scenes.provenance import stream
from scenes.ranging_model import PhysicalRanging


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """The random numbers of one scan. Each kind has a stream of its own in which a beam has its own place, whatever others meet.

    ``strength`` (beams, sub-rays): of a beam's pulses in turn; ``range`` (2, beams): of its returns; both standard normal.
    ``alarm``, ``alarm_place`` (beams,): uniform; ``alarm_strength`` (beams,): exponential with mean 1.
    """

    strength: NDArray[np.float32]
    range: Floats
    alarm: Floats
    alarm_place: Floats
    alarm_strength: Floats

    @classmethod
    def of(cls, seed: int, frame: int, name: str, shape: tuple[int, int], *, alarms: bool) -> "Noise":
        """For (beams, sub-rays) of the LIDAR ``name``."""
        beams = shape[0]
        alarm = stream(seed, frame, f"{name}.false-alarm").random((2, beams)) if alarms else np.ones((2, 0))
        return cls(
            strength=stream(seed, frame, f"{name}.strength").standard_normal(shape, dtype=np.float32),
            range=stream(seed, frame, f"{name}.range").standard_normal((2, beams)),
            alarm=alarm[0],
            alarm_place=alarm[1],
            alarm_strength=stream(seed, frame, f"{name}.false-alarm-strength").standard_exponential(beams if alarms else 0),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Returns that could be delivered, (c,) each.

    ``beam``; ``counted_e``: electrons with their noise; ``range_m``: without noise; ``sigma_m``: 1σ of it; ``pulse``: place in the
    pulses, −1 for a false alarm.
    """

    beam: NDArray[np.int64]
    counted_e: Floats
    range_m: Floats
    sigma_m: Floats
    pulse: NDArray[np.int64]

    def only(self, chosen: NDArray[np.int64]) -> "Candidates":
        """Some of them."""
        return Candidates(*(getattr(self, name)[chosen] for name in ("beam", "counted_e", "range_m", "sigma_m", "pulse")))

    def first_by(self, key: Floats) -> NDArray[np.int64]:
        """Of each beam the candidate with the least ``key``, as places among the candidates."""
        order = np.lexsort((key, self.beam))
        return order[np.diff(self.beam[order], prepend=-1) > 0]


def candidates(
    model: PhysicalRanging, found: Pulses, beams: NDArray[np.int64], background_e: Floats, gate_m: tuple[float, float], noise: Noise
) -> Candidates:
    """Pulses whose counted electrons reach the threshold, and false alarms, evenly spread over the gate.

    ``beams`` (rows,): the number of each row's beam. Gaussian noise stands for Poisson's: of ten electrons and more they differ
    little. By how much noise passes a threshold of many σ is distributed exponentially with mean σ² / threshold (Rice 1944).
    """
    background = background_e[found.beam]
    sigma_e = np.sqrt(model.noise_variance_e2(found.electrons, background))
    counted = found.electrons + sigma_e * noise.strength[beams[found.beam], found.place]
    seen = np.flatnonzero(counted >= model.threshold_e)
    sigma_m = model.range_sigma_m(counted[seen], found.stretch_m[seen], background[seen])
    alarms = np.flatnonzero(noise.alarm < model.false_alarm_probability)
    over_e = model.noise_e**2 / model.threshold_e * noise.alarm_strength[alarms]
    return Candidates(
        beam=np.concatenate([beams[found.beam[seen]], alarms]),
        counted_e=np.concatenate([counted[seen], model.threshold_e + over_e]),
        range_m=np.concatenate([found.range_m[seen], gate_m[0] + (gate_m[1] - gate_m[0]) * noise.alarm_place[alarms]]),
        sigma_m=np.concatenate([sigma_m, np.zeros(len(alarms))]),
        pulse=np.concatenate([seen, np.full(len(alarms), -1)]),
    )
