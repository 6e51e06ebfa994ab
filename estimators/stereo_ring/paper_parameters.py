"""The named numbers of ``stereo-ring-paper``: those that the paper prints, and the ones that it leaves open."""

from typing import Annotated

from pydantic import Field

from estimators.stereo_ring.circle_pair import CentreMode
from estimators.stereo_ring.detector_parameters import DetectorParameters
from estimators.stereo_ring.optical_flow import FlowSetting
from estimators.stereo_ring.regions import RegionLimits
from scenes.spec import Fraction, NonNegative, Positive

Grey = Annotated[int, Field(ge=0, le=255)]
Count = Annotated[int, Field(ge=1)]


class PaperParameters(DetectorParameters):
    """The detector's numbers and those of the pipeline behind it."""

    root_dn: Positive | None = None  # "from the original grey picture"
    min_contrast_dn: Grey = 10  # brightest less darkest pixel; below it a picture is blank

    # the ring
    centre_epipolar_px: Positive = 4.0  # between the centres of a ring's two ellipses: not the same point, 3.4 px apart for 0.6 m
    centre_mode: CentreMode = "ellipse_centre"  # what is triangulated; "pole": the image of the centre
    flow_points: Annotated[int, Field(ge=6)] = 36  # followed from frame to frame
    flow_window_px: Annotated[int, Field(ge=5)] = 21
    flow_levels: Count = 3
    flow_share: Fraction = 0.5  # of the points that must be found again
    max_deviation: NonNegative = 0.05  # D_th: mean radial deviation of followed points from an ellipse, over its radius

    # the markers
    min_grey_dn: Grey = 1
    max_grey_dn: Grey = 60
    min_area_px: NonNegative = 200.0
    max_area_px: Positive = 3000.0
    min_fill: NonNegative = 0.5  # ρ, printed as curvature
    max_fill: Positive = 1.0
    min_aspect: NonNegative = 0.7  # η, height over width
    max_aspect: Positive = 1.5
    count_box_pixels: bool = True  # False: the bounding box one pixel short, as printed in (6)
    marker_epipolar_px: Positive = 2.0
    fallback: bool = True  # without a ring, the frame of three markers of (13)

    @property
    def flow(self) -> FlowSetting:
        """What the optical flow is set to."""
        return FlowSetting(self.flow_points, self.flow_window_px, self.flow_levels, self.flow_share)

    @property
    def regions(self) -> RegionLimits:
        """What a region must be to be a marker."""
        return RegionLimits(
            (self.min_grey_dn, self.max_grey_dn),
            (self.min_area_px, self.max_area_px),
            (self.min_fill, self.max_fill),
            (self.min_aspect, self.max_aspect),
            int(self.count_box_pixels),
        )
