"""The named numbers of ``stereo-ring``, with unit and meaning; the constructor and the command line's ``--set`` override them.

Brightness is in DN of eight bits: pictures of other depths are brought to white = 255 first.
"""

from typing import Annotated

from pydantic import Field

from estimators.stereo_ring.detector_parameters import DetectorParameters
from scenes.spec import Fraction, NonNegative, Positive, Spec

Count = Annotated[int, Field(ge=1)]
Windows = tuple[Positive, ...]


class RefineParameters(Spec):
    """Sub-pixel refinement of one view's ellipses."""

    stations: Annotated[int, Field(ge=36)] = 180  # places round the ellipse where its edge is looked for
    windows_px: Windows = (9.0, 6.0, 4.0, 3.0)  # half-widths of the search, one after the other
    fit_steps: Count = 6  # iterations of weights in each window
    near_px: Positive = 0.7  # a station supports the ellipse if its edge is this near
    least_sigma_px: Positive = 0.1  # the robust scale is never taken to be less
    least_gradient_dn: Positive = 1.5  # DN a pixel of the smoothed picture: what is flatter is no edge
    share: Fraction = 0.45  # an ellipse is worth a thought if this share of its stations supports it …
    rms_px: Positive = 1.2  # … and the edges that the fit kept scatter by no more than this


class MeasureParameters(Spec):
    """Measurement of one circle in both views."""

    stations: Annotated[int, Field(ge=36)] = 720  # places round each ellipse in the last window
    coarse_stations: Annotated[int, Field(ge=36)] = 120  # and in the windows before
    least_gradient_dn: Positive = 1.5  # DN a pixel of the smoothed picture: what is flatter is no edge
    least_points: Count = 40  # edge points that each view has to give
    loss_px: Positive = 0.25  # residuals beyond count linearly
    fit_step: Positive = 1e-6  # relative decrease of the cost at which a fit rests
    trims: Count = 2  # so often the fit is repeated without the points that are far from it:
    trim_sigmas: Positive = 3.0  # those this many robust scatters away …
    trim_px: Positive = 0.3  # … but none nearer than this …
    trim_most_px: Positive = 1.5  # … and all beyond this
    judge_stations: Annotated[int, Field(ge=36)] = 360  # places where support is asked for
    judge_window_px: Positive = 1.5  # half-width in which support is looked for
    near_px: Positive = 0.5  # an edge supports the circle if it is this near …
    rms_within_px: Positive = 1.5  # … and tells how well it fits if it is this near


class AcquireParameters(Spec):
    """Search for the ring without a past."""

    nearest_m: Positive = 2.0  # depths at which a circle is looked for behind an ellipse …
    farthest_m: Positive = 14.0
    depths: Annotated[int, Field(ge=8)] = 400  # … so many, evenly spaced in their logarithm
    depths_kept: Count = 3  # best depths for each ellipse and normal
    least_radius_m: Positive = 0.1
    most_radius_m: Positive = 2.0
    normal_gap: Positive = 0.35  # |n_r − n_l| up to which two ellipses may be one circle
    epipolar_px: Positive = 2.5  # distance of the centre's images from each other's epipolar lines
    slope_sigma_px: Positive = 1.5  # smoothing of the picture in which depths are tried
    full_gradient_dn: Positive = 10.0  # DN a pixel there at which a station counts in full
    ellipses: Count = 10  # ellipses a view that are followed up
    circles: Count = 8  # circles that are measured
    windows_px: Windows = (6.0, 4.0, 3.0)
    same_size: Fraction = 0.85  # circles at least this large against the largest compete by support, smaller ones do not
    share: Fraction = 0.45  # an edge is a circle's if this share of stations supports it in both views …
    rms_px: Positive = 0.7  # … scattering by no more than this


class PromoteParameters(Spec):
    """Search for the outermost edge in the plane of a circle."""

    from_share: Positive = 0.02  # radii from this much beyond the found one …
    to_share: Positive = 0.3  # … to this much
    step_share: Positive = 0.004
    near_px: Positive = 1.0  # an edge this near speaks for the radius
    support: Fraction = 0.45  # share of stations from which a radius is measured
    windows_px: Windows = (3.0, 2.0, 1.5)
    share: Fraction = 0.42  # the edge is real if this share of stations supports it in both views …
    rms_px: Positive = 0.7  # … scattering by no more than this
    shift_share: Positive = 0.02  # and if its centre and radius are, in radii, this near where they should be
    tilt: Positive = 0.02  # rad between the two normals


class TrackParameters(Spec):
    """The ring from frame to frame, and when it is believed."""

    windows_px: Windows = (3.0, 2.0)  # half-widths of the search where the ring is predicted …
    wide_windows_px: Windows = (6.0, 4.0, 2.0)  # … and if it is not quite there
    flow_loss_px: Positive = 1.0  # residual of followed points beyond which they count linearly
    share: Fraction = 0.35  # share of stations that has to support the ring in both views
    rms_px: Positive = 0.7  # scatter of its edge
    radius_share: Positive = 0.03  # how far the radius may be from the remembered one
    radius_frames: Count = 300  # frames after which the remembered radius forgets as fast as it learns
    confirm: Count = 2  # a new ring is believed when it is there in so many …
    confirm_of: Count = 3  # … of so many frames
    believe_share: Fraction = 0.7  # or at once if this share of stations supports it in both views …
    believe_rms_px: Positive = 0.4  # … scattering by no more than this
    promote_frames: Count = 4  # a new ring's surroundings are searched for a larger edge in so many frames …
    promote_every: Count = 12  # … and then after every so many
    longest_gap_s: Positive = 5.0  # frames farther apart give no rate
    coast_frames: Count = 5  # frames over which the turn may be predicted without a marker
    coast_sigma_deg: Positive = 0.5  # growth of the turn's sigma with each of them
    fallback_frames: Count = 40  # frames over which markers alone may carry the ring's frame
    forget_frames: Count = 25  # frames without the ring after which another radius may be believed


class MarkerParameters(Spec):
    """Markers: how they are found, and what makes one sound. Areas and lengths "in the ring" scale with its picture."""

    # the sweep over grey levels
    reach: Positive = 1.75  # half-width of the part that is looked at, in the ring's major semi-axes
    sweep_semi_axis_px: Positive = 100.0  # the part is shrunk until the ring's major semi-axis is no larger
    levels: Annotated[int, Field(ge=3)] = 14  # grey levels, a constant ratio apart …
    low_percent: Annotated[float, Field(ge=0, le=100)] = 1.0  # … between these percentiles of the part
    high_percent: Annotated[float, Field(ge=0, le=100)] = 99.0
    least_area: Positive = 0.006  # area over the product of the ring's semi-axes
    most_area: Positive = 0.1
    least_fill: Fraction = 0.4  # area over that of the bounding box
    most_aspect: Positive = 2.5  # longer over shorter side of the bounding box
    same_place: Positive = 0.2  # regions are one if their centroids differ by less, in roots of their area …
    same_area: Positive = 1.6  # … and their areas by less than this factor
    least_levels: Count = 3  # levels through which a region has to last
    band_ratio: Positive = 2.4  # the same between a level and the level this much darker …
    least_band_levels: Count = 2  # … where fewer levels will do

    # what a regular mark is, seen from above; lengths in the ring's radii
    least_size: Positive = 0.08  # of the bounding square
    most_size: Positive = 0.45
    square_fill: Fraction = 0.87  # area over that of the bounding square, from which it is a square …
    disc_fill: Fraction = 0.7  # … and from which a disc (π/4)

    # a marker's own edge
    smooth_sigma_px: Positive = 0.7  # Gaussian before it is measured
    strip_px: Positive = 3.0  # two edges nearer than this are a narrow shadow's
    dip_px: Positive = 2.5  # how far inside the edge a narrow shadow is looked for:
    dip_sigmas: Positive = 3.0  # darker than the marker by so many sigmas of its own noise …
    dip_dn: Positive = 1.0  # … and by so much
    clear_share: Fraction = 0.3  # of an edge without narrow shadow, from which the rest is left out
    least_points: Count = 8  # edge points that a disc needs
    side_stations: Annotated[int, Field(ge=6)] = 24  # places on each side (on a quarter of a disc)
    corner_share: Fraction = 0.14  # of a side left out at each end
    windows_px: Windows = (4.0, 3.0, 2.0)  # half-widths of the search about a region's border
    track_windows_px: Windows = (3.0, 2.0)  # about a remembered marker's predicted border
    least_gradient_dn: Positive = 1.0  # DN a pixel of the smoothed picture: what is flatter is no edge …
    least_gradient_share: Positive = 0.04  # … nor is what is flatter than this share of the marker's own brightness
    least_sigma_px: Positive = 0.05  # the robust scale is never taken to be less
    near_px: Positive = 0.7  # an edge supports the outline if it is this near
    side_share: Fraction = 0.35  # stations of each side that have to support it
    share: Fraction = 0.6  # and of all
    rms_px: Positive = 0.4  # scatter of the edge about the outline

    # in space, in the ring's radii
    epipolar_px: Positive = 2.0
    view_area: Positive = 1.8  # ratio of the areas in both views
    lowest: float = -0.5  # height over the ring's plane
    highest: float = 0.1
    innermost: NonNegative = 0.1  # distance from the ring's axis
    outermost: Positive = 1.7
    regular_ratio: Positive = 1.35  # longest over shortest side of a square (radius of a disc)
    regular_deg: Positive = 14.0  # how far a square's angles may be from right ones


class ConstellationParameters(Spec):
    """What is remembered of the markers, in ring coordinates, and how the turn about the normal follows from them."""

    same_share: Positive = 0.05  # a sighting may be a remembered marker if radius and height differ by less, in ring radii
    vote_share: Positive = 0.05  # markers agree on a turn if they lie this near, in ring radii
    most_turn_deg: Positive = 60.0  # largest turn from the prediction that is considered
    first_scatter_m: Positive = 5e-4  # how far a new marker is thought to be from where it is remembered
    least_scatter_m: Positive = 3e-5  # and the least that any is ever thought to be
    scatter_count: Count = 20  # sightings over which that is judged
    gate_sigmas: Positive = 5.0  # residual beyond which a marker is left out of the turn …
    gate_m: Positive = 2e-3  # … but never if it is this near
    most_count: Count = 300  # sightings after which the running mean forgets as fast as it learns
    drop_after: Count = 4  # a marker is forgotten when it was missed this often more than it was seen
    settle_frames: Count = 10  # frames in which a marker nearer to the axis may still become the main one …
    settle_count: Count = 3  # … once it has been seen this often
    sweep_every: Count = 25  # frames after which new markers are looked for
    apart_m: Positive = 0.03  # a new marker has to be this far from every remembered one
    fallback_height_m: Positive = 0.2  # smallest height of the triangle that may carry the frame without the ring
    fallback_residual_m: Positive = 0.005  # and the rms distance of its markers from where they are remembered
    least_for_track: Count = 2  # with fewer remembered markers found again the whole neighbourhood is searched


class TrackedParameters(Spec):
    """``stereo-ring``: all of it."""

    smooth_sigma_px: Positive = 1.0  # Gaussian before edges are measured
    detector: DetectorParameters = DetectorParameters(polarity="any")
    refine: RefineParameters = RefineParameters()
    measure: MeasureParameters = MeasureParameters()
    acquire: AcquireParameters = AcquireParameters()
    promote: PromoteParameters = PromoteParameters()
    markers: MarkerParameters = MarkerParameters()
    constellation: ConstellationParameters = ConstellationParameters()
    track: TrackParameters = TrackParameters()
