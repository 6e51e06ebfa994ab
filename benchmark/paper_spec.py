"""What a paper's results are, figure by figure, and what is misprinted in it: data, written by hand, from the library's papers."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, StringConstraints, model_validator

from benchmark.case import Name
from scenes.config import list_library, load
from scenes.spec import Spec

Compare = Literal["at most", "at least", "nothing"]
TestId = Annotated[str, StringConstraints(pattern=r"^tests/[a-z0-9_/]+\.py::test_\w+$")]
Text = Annotated[str, StringConstraints(min_length=1)]


class Place(Spec):
    """Where a figure is measured here: a rectangle or a ring of a case, or a case's LIDAR, over so many judged ``frames``.

    Results with another number of frames are of another experiment, whatever its name. ``reason``: why a figure is not met here.
    """

    case: Name
    feature: str | None = None
    label: Text
    frames: Annotated[int, Field(ge=1)]
    reason: str = ""


class PaperFigure(Spec):
    """One figure as printed, and how ours is computed.

    ``as_printed``: its text; ``printed``: the number that ours is compared with by its magnitude, None where there is none.
    ``quantity``: a path into a method's summary, or into its runs together where it is a LIDAR's (``paper_values``), times
    ``scale`` and over what ``per`` leads to; None where nothing of ours measures it. ``follows``: the least slope of the answered
    angle on the true one; below it an answer is a constant, and its statistics say nothing. ``reasons``: the label of a place →
    why it is not met there, which goes before the place's own reason and before ``reason``.
    """

    name: Text
    unit: str = ""
    where: Text
    as_printed: Text
    printed: float | None = None
    quantity: str | None = None
    per: str | None = None
    scale: float = 1.0
    compare: Compare = "at most"
    follows: float | None = None
    form: str = "%.3g"
    reason: str = ""
    reasons: dict[str, str] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _is_comparable_or_says_why(self) -> "PaperFigure":
        if not self.is_comparable and not self.reason:
            raise ValueError(f"{self.name!r} is compared with nothing; say why in reason")
        return self

    @property
    def is_comparable(self) -> bool:
        """Whether there is a printed number, and one of ours beside it."""
        return self.compare != "nothing" and self.printed is not None and self.quantity is not None


class Group(Spec):
    """The figures of one experiment, each measured at every one of its places."""

    title: Text
    places: tuple[Place, ...]
    figures: tuple[PaperFigure, ...]

    @model_validator(mode="after")
    def _reasons_are_of_places(self) -> "Group":
        labels = [place.label for place in self.places]
        for figure in self.figures:
            for label in figure.reasons:
                if label not in labels:
                    raise ValueError(f"reasons of {figure.name!r}: no place is called {label!r} (there are: {', '.join(labels)})")
        return self


class AsPrinted(Spec):
    """The parameters with which a registered method takes the paper as it is printed."""

    estimator: Text
    parameters: Annotated[dict[str, Any], Field(min_length=1)]

    @property
    def settings(self) -> tuple[str, ...]:
        """``name=value`` of each parameter, as ``--set`` takes it."""
        return tuple(_settings(self.parameters))


class Misprint(Spec):
    """An error of the paper: ``printed`` against ``right``, what comes of following the print, and the tests that show it.

    ``as_printed``: how a method here is made to follow the print, where it can be.
    """

    where: Text
    printed: Text
    right: Text
    effect: Text
    tests: Annotated[tuple[TestId, ...], Field(min_length=1)]
    as_printed: AsPrinted | None = None


class Paper(Spec):
    """A paper: its methods here (``theirs``), those of our own beside them (``ours``), its results and its misprints."""

    title: Text
    year: int
    description: Text
    theirs: tuple[str, ...]
    ours: tuple[str, ...]
    groups: tuple[Group, ...]
    misprints: tuple[Misprint, ...] = ()

    @property
    def places(self) -> tuple[Place, ...]:
        """Where its figures are measured."""
        return tuple(place for group in self.groups for place in group.places)


def load_papers() -> tuple[Paper, ...]:
    """The library's papers, the oldest first. Raises ``ConfigError`` with every fault of one."""
    return tuple(sorted((load("paper", name, Paper) for name in list_library("paper")), key=lambda paper: paper.year))


def _settings(parameters: Mapping[str, Any], path: str = "") -> Iterator[str]:
    for name, value in parameters.items():
        if isinstance(value, Mapping):
            yield from _settings(value, f"{path}{name}.")
        else:
            yield f"{path}{name}={str(value).lower() if isinstance(value, bool) else value}"
