"""What the verbs do that help an outside method to enter: ``check`` a folder of answers, try whether a method can ``conform``."""

from pathlib import Path
from typing import Any

from benchmark.console import Console
from scenes.errors import FAULT_FOUND


def check(answers: Path, path: Path, console: Console) -> int:
    """Prints every fault of a folder of answers, and what may surprise; 1 if there is a fault."""
    from benchmark import submission
    from scenes.dataset import Dataset

    found = submission.examine(answers, Dataset.open(path))
    for sentence in found.faults:
        console.say(sentence)
    for sentence in found.notes:
        console.say(f"note: {sentence}")
    console.say(f"{answers}: {len(found.faults)} faults" if found.faults else f"{answers}: no fault found")
    return FAULT_FOUND if found.faults else 0


def conform(method: str, path: Path, told: dict[str, Any], overrides: list[str], frames: int, console: Console) -> int:
    """Prints which promises a method keeps on the first frames of a data set and how it breaks others; 1 if it breaks one."""
    from benchmark.conformance import examine
    from benchmark.knowledge import declare
    from benchmark.methods import parameters_of
    from estimators import registry
    from scenes.dataset import Dataset

    dataset, parameters = Dataset.open(path), parameters_of(overrides)
    knowledge = declare(dataset, **told).knowledge
    recording = [dataset.observation(frame) for frame in dataset.frames[:frames]]
    registry.load(method, **parameters)  # wrong usage is said before anything is tried
    promises = examine(lambda: registry.load(method, **parameters), knowledge, recording)
    for promise in promises:
        console.say(f"{'broken' if promise.faults else 'kept'}: {promise.text}")
        for fault in promise.faults:
            console.say(f"  {fault}")
    broken = sum(bool(promise.faults) for promise in promises)
    console.say(f"{method}: {broken} promises broken" if broken else f"{method}: every promise kept on {len(recording)} frames")
    return FAULT_FOUND if broken else 0
