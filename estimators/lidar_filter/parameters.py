"""The named numbers of the LIDAR methods, with unit and meaning; the constructor and the command line's ``--set`` override them."""

from typing import Annotated, Literal

from pydantic import Field

from estimators.lidar_filter.tumble_filter_parameters import TumbleParameters
from scenes.spec import Fraction, Positive, Spec

Count = Annotated[int, Field(ge=1)]
Kind = Literal["point-to-point", "point-to-plane", "robust-plane", "gicp"]


class RegistrationParameters(Spec):
    """How one scan is laid over a surface."""

    kind: Kind = "gicp"
    most_iterations: Count = 25
    least_points: Count = 20  # fewer returns, or fewer points of the surface, give no pose
    reach_m: Positive = 0.6  # points farther apart do not correspond …
    reach_sigmas: Positive = 3.0  # … but never less than so many sigmas of range
    robust_m: Positive = 0.3  # residuals beyond count nothing (Tukey's biweight) …
    robust_sigmas: Positive = 3.0  # … but never less than so many sigmas of range
    slack_m: Positive = 0.5  # 1σ with which a pair of points is told to lie within the surface: nearest points slide along it
    covariance_scale: Positive = 4.0  # on the covariance that holds the pairs for known


class VisibilityParameters(Spec):
    """What a LIDAR can see of a surface."""

    most_incidence_deg: Annotated[float, Field(gt=0, le=90)] = 80.0
    cell_m: Positive = 0.17  # width of the cones in which the nearest point hides what is behind …
    behind_m: Positive = 0.15  # … by more than this


class AcquisitionParameters(Spec):
    """The search for the first pose on a known surface."""

    directions: Annotated[int, Field(ge=12)] = 200  # of view, evenly over the sphere
    rolls: Annotated[int, Field(ge=4)] = 24  # about each of them
    cell_m: Positive = 0.45  # scan and surface are thinned to one point a cone so wide
    reach_m: Positive = 1.0  # distances count up to this among the directions and rolls …
    final_reach_m: Positive = 0.3  # … and up to this, or three sigmas of range, among what was registered
    registered: Count = 32  # the best so many are registered
    apart_deg: Positive = 12.0  # attitudes nearer than this are one
    margin: Positive = 1.25  # the best has won when every other costs so many times as much …
    most_scans: Count = 8  # … or after so many scans
    most_cost: Fraction = 0.6  # what costs more than this share of the most is no fit


class MapParameters(Spec):
    """A map of keyframes."""

    apart_deg: Positive = 10.0  # between the directions that keyframes are seen from
    cell_m: Positive = 0.1  # width of the columns in which the returns of a keyframe are averaged
    neighbours: Annotated[int, Field(ge=3)] = 12  # of a point, whose plane gives its normal
    most_scans: Count = 6  # that a keyframe takes in
    used_deg: Positive = 40.0  # keyframes seen from directions within this of the present one are registered to …
    used: Count = 6  # … but no more than so many, the nearest
    voxel_m: Positive = 0.04  # of which they keep one point
    linked_deg: Positive = 35.0  # a finished keyframe is registered to others seen from within this …
    linked: Count = 6  # … to so many that are known to lie beside it …
    looped: Count = 4  # … and to so many others
    loop_reach_m: Positive = 1.5  # distance from which those are drawn together
    loop_rmse: Positive = 1.5  # they are the same place if they fit no worse than so many times what lies beside
    least_overlap: Fraction = 0.6  # share of a keyframe that has to lie near the other
    floor_deg: Positive = 0.15  # 1σ of a pair that its own covariance leaves out, each axis …
    floor_m: Positive = 0.01
    believed_m: Positive = 0.3  # a loop that all others contradict by more than about this is left out


class TrackParameters(Spec):
    """From scan to scan."""

    least_overlap: Fraction = 0.5  # a registration with fewer of its returns near the surface is not used
    most_predictions: Count = 30  # scans in a row without a use after which the target is lost
    lost_after: Count = 3  # scans in a row that contradict the prediction, before a pose is looked for anew on a model
    predicted_deg: Positive = 2.5  # 1σ of a predicted attitude beyond which it is no answer …
    predicted_m: Positive = 0.3  # … and of a predicted position: two of them are a registration's reach


class LidarParameters(Spec):
    """``lidar-ekf``: all of it."""

    reference: Literal["auto", "model", "map", "first"] = "auto"  # auto: the model where one is told, else a map
    kind: Literal["auto"] | Kind = "auto"  # auto: gicp up to ``coarse_sigma_m``, point-to-point beyond
    coarse_sigma_m: Positive = 0.1  # 1σ of range beyond which normals of scans are of no use
    feedback: bool = True  # whether a registration starts from the filter's prediction, or from the last registration
    covariance: Literal["adaptive", "fixed", "paper"] = "adaptive"  # of a registration: its own; these two; Song et al.'s R
    fixed_m: Positive = 0.06
    fixed_deg: Positive = 1.2
    normal_neighbours: Annotated[int, Field(ge=3)] = 12  # of a scan's point, whose plane gives its normal
    registration: RegistrationParameters = RegistrationParameters()
    visibility: VisibilityParameters = VisibilityParameters()
    acquisition: AcquisitionParameters = AcquisitionParameters()
    map: MapParameters = MapParameters()
    track: TrackParameters = TrackParameters()
    filter: TumbleParameters = TumbleParameters()


def suited(parameters: LidarParameters, range_sigma_m: float) -> LidarParameters:
    """The same with the kind of registration that suits the LIDAR's stated 1σ of range, where none was chosen."""
    kind = parameters.kind
    if kind == "auto":
        kind = "gicp" if range_sigma_m <= parameters.coarse_sigma_m else "point-to-point"
    return parameters.model_copy(update={"registration": parameters.registration.model_copy(update={"kind": kind})})
