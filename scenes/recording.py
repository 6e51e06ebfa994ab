"""What a chaser would have (``Observation``) and what only the judge has (``Truth``).

Two types, so that leaking the answer is a type error.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import Floats
from scenes.intrinsics import Intrinsics


@dataclass(frozen=True, slots=True, eq=False)
class Image:
    """One camera's picture: ``pixels`` (height, width), uint8 or uint16, in DN."""

    pixels: NDArray[Any]


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """One LIDAR scan in the order of its beams, (rows, columns) each; a beam without a return is NaN in all but its time.

    ``points_lidar`` (rows, columns, 3) float32, metres, in LIDAR axes at each beam's own instant. ``intensity``: what the
    receiver reports of the return's strength. ``time_s``: when each beam was fired, counted from the observation's time.
    """

    points_lidar: NDArray[np.float32]
    intensity: NDArray[np.float32]
    time_s: NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class ChaserState:
    """What the chaser's own navigation knows of itself at ``time_s``. Inertial axes are J2000's.

    ``omega_chaser_rad_s``: the chaser's inertial angular velocity in its own axes.
    """

    time_s: float
    inertial_from_chaser: Rotation
    position_inertial_m: Floats
    velocity_inertial_m_s: Floats
    omega_chaser_rad_s: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """Everything that an estimator sees at one instant: its frame number, the time, the sensors' readings.

    ``chaser``: where the scenario's motion is an orbit, the chaser's own state at ``time_s``.
    """

    frame: int
    time_s: float
    images: Mapping[str, Image] = field(default_factory=lambda: MappingProxyType({}))
    scans: Mapping[str, Scan] = field(default_factory=lambda: MappingProxyType({}))
    chaser: ChaserState | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SensorModel:
    """What calibration says of a camera: geometry and the ends of its scale, ``black_dn`` and ``white_dn``."""

    intrinsics: Intrinsics
    black_dn: float
    white_dn: float


@dataclass(frozen=True, slots=True, eq=False)
class LidarModel:
    """What calibration says of a LIDAR: size of a scan, mount, stated 1σ of a good return, beam, window of ranges.

    ``divergence_rad``: full angle of a beam. ``duration_s``: from the first beam of a scan to its last. ``delay_s``: by how much
    the middle of a scan lies before the observation's time.
    """

    rows: int
    columns: int
    chaser_from_lidar: RigidTransform
    range_sigma_m: float
    divergence_rad: float
    least_range_m: float
    most_range_m: float
    duration_s: float = 0.0
    delay_s: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class ModelCloud:
    """The target's surface as points (n, 3) with outward unit normals (n, 3), target frame, evenly strewn."""

    points_target: Floats
    normals_target: Floats


@dataclass(frozen=True, slots=True, eq=False)
class CornerPrior:
    """Where a human operator clicked: corner pixels P1..P4 (4, 2) of the first frame, with isotropic ``sigma_px`` each."""

    sensor: str
    corners_px: Floats
    sigma_px: float


@dataclass(frozen=True, slots=True, eq=False)
class Rectangle:
    """What a method may know of its rectangle without its size.

    ``target_from_feature``: how the rectangle's axes (X normal, Y length, Z width) lie in the target frame.
    ``gap``: fractions of the length between which the long edges do not exist. ``free_standing``: open space lies
    outside its edges. ``aspect``: L/W where a suite grants it, else None.
    """

    name: str
    target_from_feature: Rotation
    gap: tuple[float, float] | None = None
    free_standing: bool = False
    aspect: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Ring:
    """What a method may know of a docking ring without its size.

    ``target_from_feature``: how the ring's frame (origin its centre, Z outward normal, X towards the marker that tells the
    rotation about the normal) lies in the target frame. ``radius_m`` where a suite grants it, else None.
    """

    name: str
    target_from_feature: RigidTransform
    radius_m: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class StereoPair:
    """A calibrated rig: the names of its cameras among the sensors, and ``right_from_left``, p_right = right_from_left · p_left."""

    left: str
    right: str
    right_from_left: RigidTransform


@dataclass(frozen=True, slots=True, eq=False)
class Knowledge:
    """Everything that an estimator is told in advance. It is printed beside its score.

    ``sensors``: cameras; ``lidars``: LIDARs. A method that answers for a LIDAR and is told no ``model`` does not know the target's
    frame: it answers in one of its own that stays fixed to the target, and the judge lays it over the true one once.
    """

    sensors: Mapping[str, SensorModel]
    rectangle: Rectangle | None = None
    corner_prior: CornerPrior | None = None
    pair: StereoPair | None = None
    ring: Ring | None = None
    lidars: Mapping[str, LidarModel] = field(default_factory=lambda: MappingProxyType({}))
    model: ModelCloud | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """What only the judge has: ``sensor_from_target`` per sensor at mid-exposure, and the row of the truth table."""

    frame: int
    time_s: float
    sensor_from_target: Mapping[str, RigidTransform]
    row: Mapping[str, Mapping[str, float]]


def grey(image: Image) -> NDArray[np.float32]:
    """The picture as float32 DN, for arithmetic."""
    return image.pixels.astype(np.float32)
