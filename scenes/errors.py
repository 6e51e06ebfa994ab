"""What can go wrong, as sentences for a person. The command line prints them and ends with ``exit_status``."""

import difflib
from collections.abc import Iterable, Sequence

FAULT_FOUND = 1
WRONG_USAGE = 2


class HardlightError(Exception):
    """Anything a user can mend. The text is one clear sentence; ``exit_status`` is what the command ends with."""

    exit_status = FAULT_FOUND


class UsageError(HardlightError):
    """The command cannot be carried out as it was given."""

    exit_status = WRONG_USAGE


class ConfigError(HardlightError):
    """What a person wrote is wrong: one line a fault, all of them at once, each naming file, key path and both values."""

    exit_status = WRONG_USAGE

    def __init__(self, faults: Sequence[str]) -> None:
        """``faults``: at least one sentence."""
        self.faults = tuple(faults)
        super().__init__("\n".join(self.faults))

    def __reduce__(self) -> tuple[type["ConfigError"], tuple[tuple[str, ...]]]:
        """Errors travel between worker processes."""
        return type(self), (self.faults,)


class AssetError(HardlightError):
    """A mesh file is missing, broken or not a surface."""

    exit_status = WRONG_USAGE


class DatasetError(HardlightError):
    """A data set is missing, incomplete, truncated or edited."""


class DatasetConflict(DatasetError):  # noqa: N818 - it is a refusal, nothing is broken
    """The output folder belongs to something else; it is left as it is."""

    exit_status = WRONG_USAGE


class StorageError(HardlightError):
    """The disk refused: full, read-only, or no permission. What was complete before is still there."""


def nearest(name: str, choices: Iterable[str]) -> str:
    """``"; did you mean 'x'?"`` with the choice most like ``name``, or an empty text where none is close."""
    by_lower = {choice.lower(): choice for choice in choices}
    close = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=0.5)
    return f"; did you mean {by_lower[close[0]]!r}?" if close else ""


def unknown(what: str, name: str, choices: Iterable[str]) -> str:
    """A sentence for a name that is not there: the nearest one, then all there are."""
    known = sorted(choices)
    listed = ", ".join(known) if known else "none"
    return f"no {what} is called {name!r}{nearest(name, known)} (there are: {listed})"
