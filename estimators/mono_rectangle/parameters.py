"""The named numbers of both methods, with unit and meaning; the constructors and the command line's ``--set`` override them."""

from typing import Annotated, Literal

from pydantic import Field

from estimators.mono_rectangle.projection import Projection
from scenes.spec import Fraction, NonNegative, Positive, Spec

Count = Annotated[int, Field(ge=1)]


class PaperParameters(Spec):
    """``mono-rectangle-paper``: the image processing that the paper names, with the usual numbers it leaves open."""

    canny_low_dn: Positive = 30.0  # hysteresis thresholds of the 3×3 Sobel gradient, 8-bit DN
    canny_high_dn: Positive = 80.0
    rho_px: Positive = 1.0
    theta_deg: Positive = 1.0
    votes: Count = 12
    band_px: Positive = 6.0  # half-width of the band about each expected edge
    first_band_sigmas: Positive = 3.0  # the same in the first frame, in sigmas of the corner prior
    turn_deg: Positive = 5.0  # how far an edge may have turned since the last frame
    gimbal_tolerance: Positive = 1e-12


class TrackedParameters(Spec):
    """``mono-rectangle``: what the search, the gates, the solution and the filter are set to."""

    # output
    filter: bool = False  # answer the filtered rotation; else each frame's own measurement
    solution: Literal["closed_form", "fit"] = "closed_form"  # "fit": orthogonality built in, maximum likelihood
    projection: Projection = "svd"
    known_aspect: Positive | None = None  # L/W, if granted; overrides Knowledge's

    # search about the predicted lines
    kernel_sigma_px: Positive = 1.0  # smoothing of the gradient across the edge
    trim_fraction: Fraction = 0.02  # of the edge's length left out at each end …
    trim_px: NonNegative = 1.5  # … and pixels on top, so that no corner is looked at
    gap_margin: Fraction = 0.02  # of the length, left out on both sides of a declared gap
    min_window_px: Positive = 3.0  # half-width of the search at a perfect prediction
    max_window_px: Positive = 16.0
    window_sigmas: Positive = 4.0
    candidates: Count = 3  # lines kept for each edge

    # an edge is visible if
    min_step: Fraction = 0.02  # its brightness step, of the scale black to white
    min_support: Fraction = 0.35  # stations that see it
    max_scale_px: Positive = 0.06  # robust scatter of its stations about the line …
    max_scale_over_noise: Positive = 2.0  # … or, if that is more, this many times what the pixels' noise explains
    max_outer_ratio: Fraction = 0.3  # free-standing: brightness outside over inside
    level_from_px: Positive = 2.5  # the levels beside an edge are read between these two distances
    level_to_px: Positive = 4.5
    edge_gate_sigmas: Positive = 3.5  # its distance from the prediction

    # the track of the four vertices
    vertex_sigma_px: Positive = 0.4  # how well a line may say where an edge is (strips, neighbours), for the track
    rate_prior_deg_s: Positive = 0.15  # 1σ of the target's angular rate before it is known
    acceleration_px2_s3: Positive = 1e-5  # power spectral density of the vertices' acceleration …
    curvature: NonNegative = 3.0  # … and how much of the motion's own v²/r is added to it
    lost_after: Count = 10  # frames with fewer than two edges until the last good quadrilateral is searched again
    lost_sigma_px: Positive = 5.0

    # accuracy and gates of the attitude
    systematic_sigma_px: Positive = 0.01  # error of an edge's end that does not average out along it
    gate_sigmas: Positive = 4.0  # innovation and r2·r3, in predicted sigmas
    aspect_sigma_px: Positive = 0.5  # how far a side may seem shifted by its own thickness, for the constancy of L/W
    max_sigma_deg: Positive = 4.0  # a measurement predicted to be worse than this is refused
    max_view_angle_deg: Positive = 78.0
    min_side_px: Positive = 8.0
    label_margin_deg: Positive = 15.0

    # the attitude filter
    rate_noise_deg2_s3: Positive = 1e-7  # power spectral density of the angular acceleration, each axis
    settled: Fraction = 1.0  # filtered answers begin when their sigma is this share of one frame's; 1: at once, with raw ones
    start_frames: Annotated[int, Field(ge=3)] = 5  # accepted frames behind the line that starts the rate
    restart_after: Count = 5  # frames refused in a row until the filter starts anew
