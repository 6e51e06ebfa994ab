"""What a method was told of, in words, for a method that was not told of what it measures."""

from collections.abc import Iterable

from scenes.recording import Knowledge


def sensors_of(knowledge: Knowledge) -> str:
    """The sensors that there are: "no cameras and the LIDAR 'nav'"."""
    return f"{_listed('camera', knowledge.sensors)} and {_listed('LIDAR', knowledge.lidars)}"


def _listed(kind: str, names: Iterable[str]) -> str:
    known = sorted(names)
    if not known:
        return f"no {kind}s"
    return f"the {kind}{'' if len(known) == 1 else 's'} {', '.join(map(repr, known))}"
