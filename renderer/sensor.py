"""A camera of our own: rays in the target's frame, with lens distortion, motion during the exposure and a moving window.

The target never moves in the renderer; camera and light move around it (moving any vertex costs as much as reloading the
scene). Rays start at the lens centre, so ``si.t`` is the distance from it.
"""

from dataclasses import dataclass
from typing import Any

from scipy.spatial.transform import RigidTransform

from renderer.rotation import turned
from scenes.arrays import Floats
from scenes.camera import Camera
from scenes.detector import AutoExposure
from scenes.intrinsics import Intrinsics

# Newton steps that invert Brown-Conrady: for |k1| up to 0.3 at the corner of a 60 degree field two leave 8e-5 px, three
# leave less than float32 resolves.
_NEWTON_STEPS = 3


@dataclass(frozen=True, slots=True)
class Shutter:
    """Where the camera is while the shutter is open, in the target's frame.

    ``target_from_cam`` holds at mid-exposure. At the relative instant τ in [−½, ½] the target has turned by −τ·``turn_rad``
    (rotation vector, target frame) and moved at constant velocity, so that the camera stands at
    exp(τ·turn) · (position + τ·``drift_m``): on the arc about a spinning target, not on its chord.
    """

    target_from_cam: RigidTransform
    drift_m: Floats
    turn_rad: Floats

    @classmethod
    def between(cls, opened: RigidTransform, middle: RigidTransform, closed: RigidTransform) -> "Shutter":
        """From the poses ``target_from_cam`` at the opening, the middle and the closing of the shutter."""
        turn = (closed.rotation * opened.rotation.inv()).as_rotvec()
        target_moved_cam = closed.inv().translation - opened.inv().translation
        return cls(middle, -middle.rotation.apply(target_moved_cam), turn)

    @property
    def constants(self) -> dict[str, Any]:
        """Plain numbers for the kernel."""
        return {
            "rotation": self.target_from_cam.rotation.as_matrix(),
            "position": self.target_from_cam.translation,
            "drift": self.drift_m,
            "turn": self.turn_rad,
        }


def longest_exposure_s(camera: Camera) -> float:
    """The longest time that the camera's shutter may be open."""
    rule = camera.exposure
    return rule.longest_s if isinstance(rule, AutoExposure) else rule.time_s


def exposure_instants_s(time_s: float, exposure_s: float) -> tuple[float, float, float]:
    """When the shutter opens, the middle of the exposure (the frame's own time), and when it closes."""
    return time_s - exposure_s / 2, time_s, time_s + exposure_s / 2


def lens_constants(intrinsics: Intrinsics) -> dict[str, float]:
    """The calibration as plain numbers for the kernel."""
    names = ("k1", "k2", "p1", "p2", "k3")
    lens = {"fx": intrinsics.fx_px, "fy": intrinsics.fy_px, "cx": intrinsics.cx_px, "cy": intrinsics.cy_px}
    return lens | dict(zip(names, intrinsics.distortion))


def camera_ray(mi: Any, dr: Any, constants: dict[str, Any], pixel: Any, tau: Any, *, distorted: bool) -> tuple[Any, Any]:
    """Ray through ``pixel`` (mi.Point2f, integer = pixel centre) at the shutter's relative instant ``tau``.

    Returns the ray in the target's frame (direction of length one) and the cosine between it and the optical axis.
    """
    c = constants
    bent = mi.Point2f((pixel.x - c["cx"]) / c["fx"], (pixel.y - c["cy"]) / c["fy"])
    ideal = _undistort(mi, c, bent) if distorted else bent
    direction_cam = dr.normalize(mi.Vector3f(ideal.x, ideal.y, 1.0))
    turn = c["turn"] * tau
    direction = dr.normalize(turned(mi, dr, c["rotation"] @ direction_cam, turn))
    origin = mi.Point3f(turned(mi, dr, c["position"] + c["drift"] * tau, turn))
    return mi.Ray3f(origin, direction), direction_cam.z


def _undistort(mi: Any, c: dict[str, Any], bent: Any) -> Any:
    """Inverse of the Brown-Conrady model (k1, k2, p1, p2, k3) by Newton's method from the distorted point."""
    x, y = bent.x, bent.y
    for _ in range(_NEWTON_STEPS):
        r2 = x * x + y * y
        radial = 1 + r2 * (c["k1"] + r2 * (c["k2"] + r2 * c["k3"]))
        slope = 2 * (c["k1"] + r2 * (2 * c["k2"] + 3 * r2 * c["k3"]))
        fx = x * radial + 2 * c["p1"] * x * y + c["p2"] * (r2 + 2 * x * x) - bent.x
        fy = y * radial + c["p1"] * (r2 + 2 * y * y) + 2 * c["p2"] * x * y - bent.y
        dxx = radial + slope * x * x + 2 * c["p1"] * y + 6 * c["p2"] * x
        dyy = radial + slope * y * y + 6 * c["p1"] * y + 2 * c["p2"] * x
        dxy = slope * x * y + 2 * c["p1"] * x + 2 * c["p2"] * y
        determinant = dxx * dyy - dxy * dxy
        x = x - (dyy * fx - dxy * fy) / determinant
        y = y - (dxx * fy - dxy * fx) / determinant
    return mi.Point2f(x, y)
