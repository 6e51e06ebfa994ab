"""The named numbers of the arc-support ellipse detector. Lengths are pixels of the camera's picture, whatever the scale."""

from typing import Annotated, Literal

from pydantic import Field

from scenes.spec import Fraction, NonNegative, Positive, Spec

Count = Annotated[int, Field(ge=1)]


class DetectorParameters(Spec):
    """``polarity``: "same" takes only ellipses that are brighter inside all round, or darker; "any" lets that change round them."""

    polarity: Literal["same", "any"] = "same"

    # the picture that is looked at
    window_contrast_dn: NonNegative = 1.5  # what is brighter than the dark by this in the mean of 16 px squared is searched
    scale: Annotated[float, Field(gt=0, le=1)] = 0.5  # of the camera's picture
    blur_px: Positive = 1.5  # Gaussian sigma before the gradient
    root_dn: Positive | None = 8.0  # edges in √(DN + this): photon noise becomes even, the dark counts; None: in DN as they are

    # line segments (LSD) and which of them support an arc
    lsd_angle_deg: Positive = 22.5
    lsd_density: Fraction = 0.7
    min_length_px: Positive = 12.0
    min_half_turn_deg: Positive = 2.5  # each half's mean gradient turns at least so much from the segment's, in opposite senses
    most_arcs: Count = 500  # the longest

    # groups of arcs that follow one another
    max_link_turn_deg: Positive = 67.5  # between the end of one and the start of the next
    max_link_gap: Positive = 1.5  # over the mean of the two lengths
    link_tolerance_deg: Positive = 20.0  # how unevenly a link may turn into the gap and out of it
    top_groups: Count = 70  # the longest

    # fits to groups and to pairs of groups
    min_semi_axis_px: Positive = 25.0
    max_semi_axis_px: Positive = 1100.0
    min_axis_ratio: Fraction = 0.35
    fit_rms_px: Positive = 3.0
    convexity_px: NonNegative = 4.0  # how far a group may lie beyond the tangents of another
    convexity_share: Fraction = 0.05  # share of tangent-point pairs that may

    growth_px: Positive = 4.0  # how far from a first ellipse segments are taken onto it
    most_grown: Count = 100  # ellipses that grow, the best covered

    # the check of each ellipse against the gradient
    normal_tolerance_deg: Positive = 22.5
    distance_px: Positive = 2.0
    min_gradient_dn_px: Positive = 2.5  # eight-bit DN (after the root, if any) a camera pixel
    min_coverage: Fraction = 0.5
    duplicate_px: Positive = 4.0  # largest distance between two ellipses that are one
    most_candidates: Count = 24
