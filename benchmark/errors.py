"""What can go wrong with answers and results, beside what ``scenes.errors`` says of scenarios and data sets."""

from scenes.errors import WRONG_USAGE, HardlightError


class PredictionsError(HardlightError):
    """A folder of answers is missing, malformed or was made on another data set."""


class ResultsConflict(HardlightError):  # noqa: N818 - it is a refusal, nothing is broken
    """The output folder belongs to something else; it is left as it is."""

    exit_status = WRONG_USAGE
