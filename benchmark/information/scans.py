"""The bound on the pose from one LIDAR scan: how each range depends on the pose, and the range's own noise."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmark.information.fisher import Bound, bound
from benchmark.model_cloud import ray_scene, triangles_of
from scenes.arrays import Bools, Floats
from scenes.beam_fate import BeamFate
from scenes.lidar import Lidar
from scenes.ranging_model import PhysicalRanging
from scenes.target import Target

_WHOLE_SPOT = 0.999  # share of the spot on one surface above which a range is that of a plane
_SAME_COSINE = 0.02  # by which the cosine of a normal may differ from the recorded incidence's; else it is another surface's


@dataclass(frozen=True, slots=True, eq=False)
class ScanBound:
    """``bound`` of one scan; ``beams`` counted in it; ``leverage``: the largest share that one beam has in fixing the pose."""

    bound: Bound
    beams: int
    leverage: float


class ScanInformation:
    """One LIDAR before one target.

    Counted are beams whose whole spot lies on one surface: that an edge was met or missed tells something too, which this bound of
    the continuous range leaves out.
    """

    def __init__(self, target: Target, lidar: Lidar) -> None:
        """Loads the target's triangles."""
        self._surface, self._lidar = ray_scene(triangles_of(target)), lidar

    def bound(self, beams: dict[str, Any], lidar_from_target: RigidTransform) -> ScanBound:
        """Of a scan's truth (``Dataset.scan_truth``) at the pose at the middle of the scan."""
        hits, cosine, chosen = self._hits(beams)
        normals = lidar_from_target.rotation.apply(self._normals(lidar_from_target.inv().apply(hits)))
        sight = hits / np.linalg.norm(hits, axis=1, keepdims=True)
        facing = np.einsum("ni,ni->n", normals, sight)
        same = np.abs(np.abs(facing) - cosine) < _SAME_COSINE
        rows = jacobian(hits[same], normals[same], lidar_from_target.translation)
        return scan_bound(rows, self._sigma_m(beams, chosen)[same])

    def _hits(self, beams: dict[str, Any]) -> tuple[Floats, Floats, Bools]:
        """Where whole spots met the target, LIDAR axes, (n, 3); the cosine of their incidence (n,); which beams they are."""
        chosen = (beams["reason"] == BeamFate.RETURN) & (beams["energy_fraction"] > _WHOLE_SPOT)
        chosen &= np.isfinite(beams["deskewed_m"]).all(axis=-1)
        return (
            beams["deskewed_m"][chosen].astype(np.float64),
            np.cos(beams["incidence_rad"][chosen].astype(np.float64)),
            np.asarray(chosen),
        )

    def _normals(self, points_target: Floats) -> Floats:
        """(n, 3) unit normals of the surface next to each point, target frame; their sign does not matter."""
        import open3d as o3d

        found = self._surface.compute_closest_points(o3d.core.Tensor.from_numpy(points_target.astype(np.float32)))
        return np.asarray(found["primitive_normals"].numpy(), dtype=np.float64)

    def _sigma_m(self, beams: dict[str, Any], chosen: Bools) -> Floats:
        """1σ of the chosen ranges, with the rounding of what is reported."""
        model = self._lidar.ranging
        if not isinstance(model, PhysicalRanging):
            return np.full(int(chosen.sum()), model.sigma_m)
        tangent = np.tan(np.minimum(beams["incidence_rad"][chosen].astype(np.float64), 1.55))
        stretch_m = beams["range_m"][chosen] * self._lidar.beam.sigma_rad * tangent
        sigma_m = model.range_sigma_m(np.maximum(beams["electrons"][chosen].astype(np.float64), 1.0), stretch_m)
        return np.asarray(np.hypot(sigma_m, model.range_step_m / np.sqrt(12)), dtype=np.float64)


def jacobian(hits: Floats, normals: Floats, origin_m: Floats) -> Floats:
    """(n, 6) ∂range/∂ξ of beams from the sensor's origin that meet planes at ``hits``: [(p × n)ᵀ, nᵀ] / (n · d), p = hit − t.

    A plane that moves by δ changes the range along d by n·δ / (n·d), and a turn ω about t moves it by ω × p.
    """
    sight = hits / np.linalg.norm(hits, axis=1, keepdims=True)
    across = np.cross(hits - origin_m, normals)
    return np.asarray(np.hstack([across, normals]) / np.einsum("ni,ni->n", normals, sight)[:, None], dtype=np.float64)


def scan_bound(rows: Floats, sigma_m: Floats) -> ScanBound:
    """I = Σ Jᵀ J / σ², and the largest leverage h = J C Jᵀ / σ²."""
    scaled = rows / sigma_m[:, None]
    found = bound(scaled.T @ scaled)
    leverage = np.einsum("ni,ij,nj->n", scaled, found.covariance, scaled)
    return ScanBound(found, len(rows), float(leverage.max(initial=0.0)) if found.is_determined else float("nan"))
