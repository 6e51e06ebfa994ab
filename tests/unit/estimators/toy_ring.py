"""A drawn docking ring for tests: exact edges by signed distances, no ray tracing. The paper's rig, a panel, a ring, markers.

The ring stands ``HEIGHT_M`` above its panel; its top is an annulus between ``inner_m`` and ``radius_m``. Light from aside leaves
a dark crescent on the panel. Everything is convex pieces painted from far to near, each pixel by the share that it covers.
"""

from dataclasses import dataclass, field
from types import MappingProxyType

import cv2
import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from estimators.stereo_ring.circle_cone import conics_of_circles
from estimators.stereo_ring.conics import Ellipse, ellipse_from_conic, sampson_px
from estimators.stereo_ring.rig import Rig, rig_from_knowledge
from scenes.arrays import frozen
from scenes.intrinsics import Intrinsics
from scenes.recording import Image, Knowledge, Observation, Ring, SensorModel, StereoPair

SIZE_PX, BASELINE_M, HEIGHT_M = 2048, 1.3, 0.1
FOCAL_PX = SIZE_PX / 2 / np.tan(np.radians(30))
LENS = Intrinsics(SIZE_PX, SIZE_PX, FOCAL_PX, FOCAL_PX, (SIZE_PX - 1) / 2, (SIZE_PX - 1) / 2)
LEFT, RIGHT = "stereo-left", "stereo-right"
PANEL_DN, WALL_DN, TOP_DN, INSIDE_DN, SHADOW_DN, MARKER_DN, SPACE_DN = 120.0, 90.0, 200.0, 105.0, 25.0, 20.0, 3.0


def knowledge(toe_in_deg: float = 18.0, **changes) -> Knowledge:
    """What a stereo method is told; ``changes`` replace fields."""
    tau = np.radians(toe_in_deg)
    turn = Rotation.from_euler("y", 2 * tau)
    pair = StereoPair(LEFT, RIGHT, RigidTransform.from_components([-BASELINE_M * np.cos(tau), 0, BASELINE_M * np.sin(tau)], turn))
    model = SensorModel(LENS, 0.0, 255.0)
    told = {"sensors": {LEFT: model, RIGHT: model}, "pair": pair, "ring": Ring("ring", RigidTransform.identity())}
    return Knowledge(**(told | changes))


def rig(toe_in_deg: float = 18.0) -> Rig:
    return rig_from_knowledge(knowledge(toe_in_deg))


def left_from_ring(range_m: float, about_x_deg: float = 0.0, about_y_deg: float = 0.0, spin_deg: float = 0.0, aside_m=(0.0, 0.0)):
    """A ring that faces the middle of the paper's rig from ``range_m``, turned by tilts, with a spin about its normal."""
    facing = Rotation.from_matrix(np.diag([1.0, -1.0, -1.0]))
    tilt = Rotation.from_euler("xy", [about_x_deg, about_y_deg], degrees=True)
    ring = RigidTransform.from_components([*aside_m, range_m], tilt * facing * Rotation.from_euler("z", spin_deg, degrees=True))
    left_from_rig = RigidTransform.from_rotation(Rotation.from_euler("y", -18, degrees=True))
    return left_from_rig * RigidTransform.from_translation([BASELINE_M / 2, 0, 0]) * ring


@dataclass(frozen=True)
class Scene:
    """``markers``: (x, y, half size in metres, "disc" or "square"), on the panel; ``light``: direction to it, ring frame."""

    left_from_ring: RigidTransform
    radius_m: float = 0.6
    inner_m: float = 0.56
    light: tuple[float, float, float] = (0.0, 0.0, 1.0)
    markers: tuple = ((0.22, 0.0, 0.05, "disc"), (-0.15, 0.28, 0.045, "square"), (-0.2, -0.25, 0.045, "square"))
    half_m: float = 0.78
    texture_dn: float = 0.0
    values: dict = field(default_factory=dict)

    def conic(self, view: int, radius_m: float, at=(0.0, 0.0, 0.0), pair: Rig | None = None):
        """C of a circle parallel to the ring's plane about ``at`` (ring frame)."""
        pair = pair or rig()
        normal = self.left_from_ring.rotation.apply([0, 0, 1.0])
        return conics_of_circles(self.left_from_ring.apply(at), normal, radius_m, pair.projections[view])

    def ellipse(self, view: int, radius_m: float | None = None) -> Ellipse:
        """The true outer edge of the ring in a view."""
        return ellipse_from_conic(self.conic(view, radius_m or self.radius_m))

    def pixels(self, points_ring, view: int):
        seen = self.left_from_ring.apply(points_ring) @ rig().projections[view][:, :3].T + rig().projections[view][:, 3]
        return seen[:, :2] / seen[:, 2:]

    def observation(self, frame: int = 0, seed: int = 0, sigma_dn: float = 1.0) -> Observation:
        images = {name: Image(frozen(expose(draw(self, v), (seed, v), sigma_dn), np.uint8)) for v, name in enumerate((LEFT, RIGHT))}
        return Observation(frame, float(frame), MappingProxyType(images))


def draw(scene: Scene, view: int):
    """Noise-free picture (2048, 2048), float32 DN, blurred by a lens."""
    value = scene.values.get
    picture = np.full((SIZE_PX, SIZE_PX), value("space", SPACE_DN), np.float32)
    h, base = scene.half_m, -HEIGHT_M
    panel = scene.pixels([(-h, -h, base), (h, -h, base), (h, h, base), (-h, h, base)], view)
    surface = value("panel", PANEL_DN)
    if scene.texture_dn:
        grain = cv2.resize(np.random.default_rng(9).normal(0, scene.texture_dn, (128, 128)).astype(np.float32), (SIZE_PX, SIZE_PX))
        surface = surface + grain
    paint_polygon(picture, panel, surface)
    offset = -HEIGHT_M * np.array(scene.light[:2]) / scene.light[2]
    for share in np.linspace(0, 1, 12 if offset.any() else 1):
        paint_ellipse(picture, scene.conic(view, scene.radius_m, (*(share * offset), base)), value("shadow", SHADOW_DN))
    for level in np.linspace(base, 0, 12):
        paint_ellipse(picture, scene.conic(view, scene.radius_m, (0, 0, level)), value("wall", WALL_DN))
    paint_ellipse(picture, scene.conic(view, scene.radius_m), value("top", TOP_DN))
    paint_ellipse(picture, scene.conic(view, scene.inner_m), value("inside", INSIDE_DN))
    for x, y, half, shape in scene.markers:
        if shape == "disc":
            paint_ellipse(picture, scene.conic(view, half, (x, y, base)), value("marker", MARKER_DN))
        else:
            corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * half + [x, y, base]
            paint_polygon(picture, scene.pixels(corners, view), value("marker", MARKER_DN))
    return cv2.GaussianBlur(picture, (5, 5), 0.6)


def expose(signal, seed, sigma_dn: float = 1.0):
    """Eight bits with white noise of ``sigma_dn``."""
    noise = np.random.default_rng(seed).standard_normal(signal.shape, dtype=np.float32)
    return np.clip(np.rint(signal + np.float32(sigma_dn) * noise), 0, 255).astype(np.uint8)


def paint_ellipse(picture, conic, value) -> None:
    """Lays an ellipse of ``value`` (a number or a picture) over ``picture``."""
    ellipse = ellipse_from_conic(conic)
    reach = ellipse.a_px + 2
    _paint(picture, ellipse.centre_px - reach, ellipse.centre_px + reach, lambda points: sampson_px(conic, points), value)


def paint_polygon(picture, corners_px, value) -> None:
    """The same for a convex polygon (n, 2)."""
    corners = np.asarray(corners_px, dtype=np.float64)
    sides = np.roll(corners, -1, axis=0) - corners
    outward = np.stack([sides[:, 1], -sides[:, 0]], axis=1) / np.linalg.norm(sides, axis=1)[:, None]
    outward *= np.sign(np.sum(outward * (corners - corners.mean(axis=0)), axis=1))[:, None]
    distance = lambda points: np.max(points @ outward.T - np.sum(outward * corners, axis=1), axis=-1)  # noqa: E731
    _paint(picture, corners.min(axis=0) - 2, corners.max(axis=0) + 2, distance, value)


def _paint(picture, low, high, distance_px, value) -> None:
    height, width = picture.shape
    u0, v0 = np.maximum(np.floor(low), 0).astype(int)
    u1, v1 = np.minimum(np.ceil(high) + 1, [width, height]).astype(int)
    if u0 >= u1 or v0 >= v1:
        return
    points = np.stack(np.meshgrid(np.arange(u0, u1), np.arange(v0, v1)), axis=-1).astype(np.float64)
    share = np.clip(0.5 - distance_px(points), 0, 1).astype(np.float32)
    window = picture[v0:v1, u0:u1]
    laid = value[v0:v1, u0:u1] if np.ndim(value) else np.float32(value)
    window += share * (laid - window)
