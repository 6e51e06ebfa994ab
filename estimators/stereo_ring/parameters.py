"""The named numbers of ``stereo-ring``, with unit and meaning; the constructor and the command line's ``--set`` override them.

Brightness is in DN of eight bits: pictures of other depths are brought to white = 255 first.
"""

from typing import Annotated

from pydantic import Field

from estimators.stereo_ring.detector_parameters import DetectorParameters
from estimators.stereo_ring.marker_parameters import ConstellationParameters, MarkerParameters
from scenes.spec import Fraction, Positive, Spec

Count = Annotated[int, Field(ge=1)]
Windows = tuple[Positive, ...]


class RefineParameters(Spec):
    """Sub-pixel refinement of one view's ellipses."""

    stations: Annotated[int, Field(ge=36)] = 180  # places round the ellipse where its edge is looked for
    windows_px: Windows = (9.0, 5.0, 3.0)  # half-widths of the search, one after the other
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
    depths: Annotated[int, Field(ge=8)] = 320  # … so many, evenly spaced in their logarithm
    depths_kept: Count = 3  # best depths for each ellipse and normal
    least_radius_m: Positive = 0.1
    most_radius_m: Positive = 2.0
    normal_gap: Positive = 0.35  # |n_r − n_l| up to which two ellipses may be one circle
    epipolar_px: Positive = 2.5  # distance of the centre's images from each other's epipolar lines
    slope_sigma_px: Positive = 1.5  # smoothing of the picture in which depths are tried
    full_gradient_dn: Positive = 10.0  # DN a pixel there at which a station counts in full
    ellipses: Count = 6  # ellipses a view that are followed up
    looked_at: Count = 80  # circles that are looked at in the fine picture
    near_px: Positive = 1.0  # an edge there speaks for a circle if it is this near
    circles: Count = 4  # circles that are measured
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
    support: Fraction = 0.45  # share of stations from which a radius is measured …
    above_median: Fraction = 0.12  # … if it is this much above what other radii have
    radii: Count = 3  # the best so many
    windows_px: Windows = (3.0, 2.0, 1.5)
    share: Fraction = 0.42  # the edge is real if this share of stations supports it in both views …
    rms_px: Positive = 0.7  # … scattering by no more than this
    shift_share: Positive = 0.03  # and if its centre and radius are, in radii, this near where they should be
    tilt: Positive = 0.05  # rad between the two normals
    inner_from_share: Positive = 0.75  # the face's inner edge is looked for from this share of the radius …
    inner_to_share: Positive = 0.985  # … to this
    inner_share: Fraction = 0.5  # and is real if this share of stations supports it in both views


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
    farthest_m: Positive = 0.01  # a centre farther than this from its path begins a new one, where it is filtered
    coast_frames: Count = 5  # frames over which the turn may be predicted without a marker
    unmarked_frames: Count = 12  # frames without a marker after which a ring is taken for another circle, and left
    coast_sigma_deg: Positive = 0.5  # growth of the turn's sigma with each of them
    fallback_frames: Count = 40  # frames over which markers alone may carry the ring's frame
    forget_frames: Count = 25  # frames without the ring after which another radius may be believed


class TrackedParameters(Spec):
    """``stereo-ring``: all of it."""

    centre_gain: Annotated[float, Field(gt=0, le=1)] = 1.0  # share of a frame in the answered centre; 1: no filter over time
    smooth_sigma_px: Positive = 1.0  # Gaussian before edges are measured
    detector: DetectorParameters = DetectorParameters(polarity="any")
    refine: RefineParameters = RefineParameters()
    measure: MeasureParameters = MeasureParameters()
    acquire: AcquireParameters = AcquireParameters()
    promote: PromoteParameters = PromoteParameters()
    markers: MarkerParameters = MarkerParameters()
    constellation: ConstellationParameters = ConstellationParameters()
    track: TrackParameters = TrackParameters()
