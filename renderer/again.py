"""Renders frames of a finished data set once more and compares them bit by bit."""

from collections.abc import Iterable, Iterator

from renderer.generate import FrameMaker, manifest_of
from renderer.variant import probe
from scenes.dataset import Dataset
from scenes.dataset_layout import frame_folder
from scenes.dataset_manifest import differences
from scenes.dataset_writer import frame_files
from scenes.scenario import Scenario


def cannot_compare(dataset: Dataset) -> str:
    """Why this machine's frames may differ from the data set's in bits (another backend or version), or an empty text."""
    scenario = Scenario.model_validate(dataset.scenario)
    return "; ".join(differences(dataset.manifest, manifest_of(scenario, dataset.manifest.selected, probe())))


def rerender(dataset: Dataset, frames: Iterable[int]) -> Iterator[tuple[int, list[str]]]:
    """Each frame with its faults: one sentence for every file whose bytes differ from those in the folder."""
    maker = FrameMaker(Scenario.model_validate(dataset.scenario))
    for frame in frames:
        made = frame_files(dataset.manifest, maker.record(frame))
        folder = frame_folder(dataset.path, frame)
        changed = [name for name, data in made.items() if (folder / name).read_bytes() != data]
        yield frame, [f"{folder / name}: rendered again, it has other bytes" for name in changed]
