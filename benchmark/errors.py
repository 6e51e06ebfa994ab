"""What can go wrong with answers and results, beside what ``scenes.errors`` says of scenarios and data sets."""

from pathlib import Path

from pydantic import ValidationError

from scenes.errors import WRONG_USAGE, HardlightError


class PredictionsError(HardlightError):
    """A folder of answers is missing, malformed or was made on another data set."""


class ResultsConflict(HardlightError):  # noqa: N818 - it is a refusal, nothing is broken
    """The output folder belongs to something else; it is left as it is."""

    exit_status = WRONG_USAGE


def damaged(path: Path, error: ValidationError) -> PredictionsError:
    """What to raise where a file of results is not what its format says: the first fault, and where in the file it is."""
    fault = error.errors(include_url=False)[0]
    return PredictionsError(f"{path} is damaged: {'.'.join(map(str, fault['loc'])) or 'the file'}: {fault['msg']}")
