"""A LIDAR as a person describes it."""

from typing import Literal

from scenes.camera import Mount
from scenes.spec import Spec


class Lidar(Spec):
    """A LIDAR and where it is mounted. Its axes are a camera's: x right, y down, z along the middle of its field."""

    type: Literal["lidar"] = "lidar"
    description: str = ""
    source: str = ""
    mount: Mount = Mount()
