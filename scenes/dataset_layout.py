"""Names inside a data set folder (format ``hardlight-dataset`` version 1); the one place that knows them."""

from pathlib import Path
from typing import Final

FORMAT: Final = "hardlight-dataset"
VERSION: Final = 1
MANIFEST = "manifest.json"
TRUTH_TABLE = "truth.parquet"
FRAMES = "frames"
ASSETS = "assets"
FRAME_FILE = "frame.json"
TEMPORARY = ".tmp-"  # prefix of what is not published yet: .tmp-<pid>-<name>

POSE_COLUMNS = ("qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m")
# The truth of one frame and sensor. Pose = sensor_from_target; light_* = unit vector to the light, sensor axes;
# omega_* = angular velocity of the target, body axes; fractions of the target's pixels. NaN where a quantity does not apply.
TRUTH_COLUMNS = (
    *POSE_COLUMNS,
    "range_m",
    "light_x",
    "light_y",
    "light_z",
    "phase_angle_deg",
    "visible_fraction",
    "lit_fraction",
    "shadow_fraction",
    "specular_fraction",
    "saturated_fraction",
    "omega_x_rad_s",
    "omega_y_rad_s",
    "omega_z_rad_s",
)


def frame_folder(dataset: Path, frame: int) -> Path:
    """Folder of one frame: frames/000123."""
    return dataset / FRAMES / f"{frame:06d}"


def scan_name(lidar: str) -> str:
    """What the LIDAR delivers."""
    return f"{lidar}.pcd"


def beams_name(lidar: str) -> str:
    """What only a simulation knows of the same beams."""
    return f"{lidar}_truth.npz"


def image_name(camera: str) -> str:
    """What the camera delivers."""
    return f"{camera}.png"


def layers_name(camera: str) -> str:
    """What only a simulation knows of the same picture."""
    return f"{camera}_truth.exr"
