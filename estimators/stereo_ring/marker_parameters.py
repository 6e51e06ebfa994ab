"""The named numbers for markers, with unit and meaning. Brightness is in DN of eight bits, white = 255."""

from typing import Annotated

from pydantic import Field

from scenes.spec import Fraction, NonNegative, Positive, Spec

Count = Annotated[int, Field(ge=1)]
Windows = tuple[Positive, ...]


class MarkerParameters(Spec):
    """Markers: how they are found, and what makes one sound. Areas and lengths "in the ring" scale with its picture."""

    # the sweep over grey levels
    reach: Positive = 1.75  # half-width of the part that is looked at, in the ring's major semi-axes
    sweep_semi_axis_px: Positive = 80.0  # the part is shrunk until the ring's major semi-axis is no larger
    levels: Annotated[int, Field(ge=3)] = 16  # grey levels, a constant ratio apart …
    first_level_dn: Positive = 1.5  # … the first so much above the darkest …
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
    whole_share: Fraction = 0.75  # of a disc's edge, from which the displacement of its own shadow can be told
    least_offset_px: Positive = 0.4  # displacements of a disc's own shadow that are told from none …
    most_offset_px: Positive = 4.0  # … up to those that are none
    side_stations: Annotated[int, Field(ge=6)] = 24  # places on each side (on a quarter of a disc)
    corner_share: Fraction = 0.14  # of a side left out at each end
    windows_px: Windows = (4.0, 3.0, 2.0)  # half-widths of the search about a region's border
    track_windows_px: Windows = (3.0, 2.0)  # about a remembered marker's predicted border
    least_gradient_dn: Positive = 0.5  # DN a pixel of the smoothed picture: what is flatter is no edge …
    least_gradient_share: Positive = 0.03  # … nor is what is flatter than this share of the marker's own brightness …
    least_gradient_noise: Positive = 1.2  # … or than this many times a pixel's noise (four sigmas of the gradient)
    least_sigma_px: Positive = 0.05  # the robust scale is never taken to be less
    near_px: Positive = 0.7  # an edge supports the outline if it is this near
    side_share: Fraction = 0.35  # stations of each side that have to support it
    share: Fraction = 0.6  # and of all
    rms_px: Positive = 0.5  # scatter of the edge about the outline

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
    least_scatter_m: Positive = 3e-5  # the least that a marker is ever thought to be from where it is remembered
    scatter_count: Count = 20  # sightings over which that is judged
    gate_sigmas: Positive = 5.0  # residual beyond which a marker is left out of the turn …
    gate_m: Positive = 2e-3  # … but never if it is this near
    most_count: Count = 300  # sightings after which the running mean forgets as fast as it learns
    drop_after: Count = 4  # a marker is forgotten when it was missed this often more than it was seen
    settle_frames: Count = 10  # frames in which a marker nearer to the axis may still become the main one …
    settle_count: Count = 3  # … once it has been seen this often …
    doubtful: Positive = 3.0  # … and is the main one if that was then missed this many times as often as it was seen
    sweep_every: Count = 25  # frames after which new markers are looked for …
    enough: Count = 4  # … unless so many of the remembered ones are seen
    apart_m: Positive = 0.03  # a new marker has to be this far from every remembered one, in the plane
    fallback_height_m: Positive = 0.2  # smallest height of the triangle that may carry the frame without the ring
    fallback_residual_m: Positive = 0.005  # and the rms distance of its markers from where they are remembered
    least_for_track: Count = 2  # with fewer remembered markers found again the whole neighbourhood is searched
