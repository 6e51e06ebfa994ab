"""Outside methods that do in frame 1 what no method should, and answer a constant attitude otherwise."""

import contextlib
import ctypes
import os
import sys
import threading
import time

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.api import Estimate, Outcome
from scenes.recording import Knowledge, Observation

AT_FRAME = 1


class Constant:
    """The same attitude for every frame, wrong nearly always, but an answer."""

    def start(self, knowledge: Knowledge) -> None:
        self.sensor = next(iter(knowledge.sensors))

    def step(self, observation: Observation) -> Estimate:
        return self.misbehave(observation) if observation.frame == AT_FRAME else self.answer()

    def answer(self) -> Estimate:
        return Estimate(self.sensor, Outcome.OK, Rotation.from_euler("xyz", [10.0, 20.0, 30.0], degrees=True))

    def misbehave(self, observation: Observation) -> Estimate:
        raise NotImplementedError


class Raises(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        raise ZeroDivisionError("division by zero")


class Hangs(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        while True:
            time.sleep(60)


class Leaks(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        hoard = []
        while True:
            hoard.append(np.ones(1 << 22))


class NotANumber(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        return Estimate(self.sensor, Outcome.OK, self.answer().sensor_from_target, np.array([0.0, np.nan, 10.0]))


class Quaternion:
    """A rotation of one's own making, which nobody normalised."""

    def as_quat(self, canonical: bool = False, *, scalar_first: bool = False) -> np.ndarray:
        return np.array([2.0, 0.0, 0.0, 0.0])


class NotUnit(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        return Estimate(self.sensor, Outcome.OK, Quaternion())


class Identity(Constant):
    def step(self, observation: Observation) -> Estimate:
        return Estimate(self.sensor, Outcome.OK, Rotation.identity())


class PoseWithFailure(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        return Estimate(self.sensor, Outcome.NOT_CONVERGED, Rotation.identity(), reason="but here is one")


class Prints(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        line = "x" * 1023 + "\n"
        for _ in range(1024):
            sys.stdout.write(line * 1024)
        print("the last line")
        return self.answer()


class Mutates(Constant):
    """Blackens its pictures, although they are read-only; it would find the black in a later frame, or another method would."""

    def step(self, observation: Observation) -> Estimate:
        pixels = observation.images[self.sensor].pixels
        if not pixels.any():
            return Estimate(self.sensor, Outcome.NO_FEATURES, reason="the picture is black")
        ctypes.memset(pixels.ctypes.data, 0, pixels.nbytes)
        return self.answer()


class Exits(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        os._exit(3)


class Segfaults(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        ctypes.string_at(0)
        return self.answer()


class Interrupts(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        raise KeyboardInterrupt


class Alien(Constant):
    """What it returns cannot be pickled, nor read."""

    def misbehave(self, observation: Observation) -> Estimate:
        return lambda: None


class HangsInStart(Constant):
    def start(self, knowledge: Knowledge) -> None:
        time.sleep(600)


class Breeds(Constant):
    """Leaves a child behind that holds everything open, and hangs."""

    def misbehave(self, observation: Observation) -> Estimate:
        if os.fork() == 0:
            time.sleep(600)
        os._exit(0)


class Meddles(Constant):
    """Writes into every file that is open."""

    def misbehave(self, observation: Observation) -> Estimate:
        for descriptor in range(3, 64):
            with contextlib.suppress(OSError):
                os.write(descriptor, b"nonsense, and more of it")
        return self.answer()


class ClosesOutputs(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        os.close(1)
        os.close(2)
        return self.answer()


class ClosesEverything(Constant):
    def misbehave(self, observation: Observation) -> Estimate:
        os.closerange(0, 256)
        return self.answer()


class Floods(Constant):
    """Its thread goes on printing after it has answered."""

    def misbehave(self, observation: Observation) -> Estimate:
        threading.Thread(target=self._print, daemon=True).start()
        return self.answer()

    def _print(self) -> None:
        while True:
            os.write(1, b"more and more\n" * 1000)
