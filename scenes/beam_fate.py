"""What became of a beam: the numbers in a scan's truth."""

from enum import IntEnum


class BeamFate(IntEnum):
    """Why a beam has a return or none."""

    RETURN = 0
    NOTHING = 1  # the spot meets nothing
    GATED = 2  # all that the spot meets lies outside of the gate
    GRAZING = 3  # too weak; the same surface would have been seen face on
    MIRROR = 4  # too weak; a matt surface of the same albedo would have been seen: the light went elsewhere
    DARK = 5  # too weak in any attitude: dark or far
    CUT_OFF = 6  # removed by the paper's dead zone at large angles
    FALSE_ALARM = 7  # a return of noise alone
    NO_SECOND = 8  # only in a second block of rows: no second return; the first block says what became of the beam


# Column of the truth table for each, beside ``returns``, which counts those that are not noise.
COUNTS = {
    BeamFate.GATED: "dropouts_gated",
    BeamFate.GRAZING: "dropouts_grazing",
    BeamFate.MIRROR: "dropouts_mirror",
    BeamFate.DARK: "dropouts_dark",
    BeamFate.CUT_OFF: "dropouts_cut_off",
    BeamFate.FALSE_ALARM: "false_alarms",
}
