"""The named numbers of ``lidar-ekf-paper``."""

from typing import Literal

from estimators.lidar_filter.paper_filter_parameters import PaperFilterParameters
from estimators.lidar_filter.parameters import (
    AcquisitionParameters,
    Count,
    LidarParameters,
    RegistrationParameters,
    VisibilityParameters,
)
from scenes.spec import Spec


class PaperLidarParameters(Spec):
    """``lidar-ekf-paper``: point-to-point ICP of at most 25 iterations that starts where the filter expects; Song et al. 2017."""

    reference: Literal["auto", "model", "map", "first"] = "auto"  # the paper does not say; its figure of the cloud suggests a model
    feedback: bool = True  # whether ICP starts from the filter's prediction, or from where it last came to rest
    most_predictions: Count = 30  # scans in a row without a registration after which there is no answer
    registration: RegistrationParameters = RegistrationParameters(kind="point-to-point", most_iterations=25)
    visibility: VisibilityParameters = VisibilityParameters()
    acquisition: AcquisitionParameters = AcquisitionParameters()
    filter: PaperFilterParameters = PaperFilterParameters()

    @property
    def of_reference(self) -> LidarParameters:
        """The same for what scans are laid over."""
        shared = {name: getattr(self, name) for name in ("reference", "registration", "visibility", "acquisition")}
        return LidarParameters(kind="point-to-point", **shared)
