"""What a case asks for: a rectangle in one camera's pictures, a ring in two cameras', a target in a LIDAR's scans."""

from dataclasses import dataclass
from typing import Literal

from scenes.features import CircleFeature, Feature

Modality = Literal["mono", "stereo", "lidar"]
NAMES: dict[str, str] = {"mono": "One camera", "stereo": "Stereo", "lidar": "LIDAR"}  # headings, in the order of pages
MEASURES = {"mono": "rectangles", "stereo": "rings", "lidar": "scans"}


@dataclass(frozen=True, slots=True)
class Subject:
    """One thing that methods answer: a feature's name, or a LIDAR's where ``modality`` is ``lidar``."""

    name: str
    modality: Modality

    @property
    def feature(self) -> str | None:
        """The feature's name, None of a LIDAR."""
        return None if self.modality == "lidar" else self.name

    @property
    def lidar(self) -> str | None:
        """The LIDAR's name, None of a feature."""
        return self.name if self.modality == "lidar" else None

    def __str__(self) -> str:
        """As a sentence names it."""
        kind = {"mono": "the rectangle", "stereo": "the ring", "lidar": "the LIDAR"}[self.modality]
        return f"{kind} {self.name!r}"


def of_feature(feature: Feature) -> Subject:
    """A rectangle is what one camera measures, a circle what two do."""
    return Subject(feature.name, "stereo" if isinstance(feature, CircleFeature) else "mono")
