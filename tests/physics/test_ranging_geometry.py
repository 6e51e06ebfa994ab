"""Where beams meet the target: against Open3D's ray tracer, and with a target that moves while it is scanned."""

import numpy as np
import open3d as o3d
import pytest
from oracles.soundings import NAME, lidar, measured_m, scenario, sounding
from oracles.studio import LAMBERT, box, inside, still
from scipy.spatial.transform import RigidTransform, Rotation

from renderer.ranging import Scanner
from scenes.arrays import Floats
from scenes.scenario import Scenario, load_scenario, realize
from scenes.solids import solids
from scenes.target import Target

PAPER = {"type": "paper", "sigma_m": 0.0}
TURNING = {"omega_target_deg_s": (3.0, -20.0, 10.0), "velocity_m_s": (0.2, -0.1, 0.5)}


class Open3dLidar:
    """A target in Open3D, independent of Mitsuba."""

    def __init__(self, target: Target) -> None:
        self._scene = o3d.t.geometry.RaycastingScene()
        for solid in solids(target):
            vertices = o3d.core.Tensor(solid.vertices_target.astype(np.float32))
            self._scene.add_triangles(vertices, o3d.core.Tensor(solid.faces.astype(np.uint32)))

    def cast(self, target_from_lidar: list[RigidTransform] | RigidTransform, rays_lidar: Floats) -> tuple[Floats, Floats]:
        """Ranges (n,), inf where nothing is hit, and outward normals (n, 3), target axes; one pose, or one a ray."""
        if isinstance(target_from_lidar, RigidTransform):
            turned, origins = target_from_lidar.rotation.apply(rays_lidar), target_from_lidar.translation[None]
        else:
            turned = np.array([pose.rotation.apply(ray) for pose, ray in zip(target_from_lidar, rays_lidar)])
            origins = np.array([pose.translation for pose in target_from_lidar])
        both = np.concatenate([np.broadcast_to(origins, turned.shape), turned], axis=1).astype(np.float32)
        found = self._scene.cast_rays(o3d.core.Tensor(both))
        return found["t_hit"].numpy().astype(np.float64), found["primitive_normals"].numpy().astype(np.float64)


def _satellite(attitude_deg: tuple[float, float, float]) -> Scenario:
    """The crinkled satellite at 12 m before a flash of 384 × 384 single rays."""
    field = {"type": "flash", "columns": 384, "rows": 384, "field_deg": (12.0, 12.0)}
    device = lidar(PAPER, {"sub_rays": 1}, pattern=field)
    satellite = load_scenario("shu2020-exp1").target
    return scenario([], device, still(12.0, attitude_deg), target=satellite)


@pytest.mark.parametrize("attitude_deg", [(180.0, 0.0, 0.0), (120.0, 40.0, 10.0), (-60.0, 100.0, 30.0)])
def test_masks_and_ranges_are_those_of_open3d(attitude_deg: tuple[float, float, float]):
    case = _satellite(attitude_deg)
    scene = realize(case, 0, 0)
    rays = case.lidars[NAME].pattern.beams.directions_lidar.reshape(-1, 3)
    theirs, normals = Open3dLidar(case.target).cast(scene.chaser_from_target.inv(), np.array(rays))
    echoes = Scanner(case, NAME).echoes(scene)
    hit, wanted = (echoes.range_m[:, 0] > 0).reshape(384, 384), np.isfinite(theirs).reshape(384, 384)
    away = inside(wanted) | inside(~wanted)
    assert wanted.mean() > 0.2
    assert (hit == wanted)[away].all()
    assert (hit == wanted).mean() > 0.9999
    both = (hit & wanted).ravel()
    assert np.percentile(np.abs(echoes.range_m[both, 0] - theirs[both]), 99.9) < 1e-5
    turned = scene.chaser_from_target.inv().rotation.apply(np.array(rays))
    cosine = -np.sum(normals * turned, axis=1)
    # Either tracer takes normals from float32 corners: 1e-7 m on the edges of millimetres that the crinkles have.
    assert np.percentile(np.abs(echoes.cosine[both, 0] - cosine[both]), 99.9) < 3e-4


def _moving(pattern: dict[str, object], **motion: object) -> Scenario:
    parts = [box((2.0, 1.6, 0.4), LAMBERT), box((0.4, 0.4, 0.8), LAMBERT, "mast", centre_m=(0.5, 0.3, -0.5))]
    device = lidar(PAPER, {"sub_rays": 7}, pattern=pattern, delay_s=0.3, mount={"position_m": (0.1, -0.2, 0.5)})
    return scenario(parts, device, still(12.0, (10.0, 20.0, 30.0), **motion))


RASTER = {"type": "raster", "columns": 60, "rows": 60, "field_deg": (14.0, 14.0), "scan_s": 1.5, "bidirectional": True}
ROSETTE = {"type": "rosette", "beams_per_scan": 2500, "deflection_deg": (3.0, 3.5), "turns_hz": (21.0, -13.0), "scan_s": 1.5}


@pytest.mark.parametrize("pattern", [RASTER, ROSETTE])
def test_every_beam_is_cast_from_its_own_instant(pattern: dict[str, object]):
    """Ranges of a scan of a target that turns by 34 deg during it, beam by beam against Open3D at each beam's own pose."""
    case = _moving(pattern, **TURNING)
    scene, beams = realize(case, 0, 3), case.lidars[NAME].pattern.beams
    one = Scanner(case, NAME).take(scene)
    times = scene.time_s + one.scan.time_s.astype(np.float64).ravel()
    assert times.min() == pytest.approx(3.0 - 0.3 - 0.75)
    assert times.max() == pytest.approx(3.0 - 0.3 + 0.75)
    chaser_from_lidar = case.lidars[NAME].mount.chaser_from_cam
    poses = [(chaser_from_lidar.inv() * scene.pose_at(float(at))).inv() for at in times]
    theirs, _ = Open3dLidar(case.target).cast(poses, np.array(beams.directions_lidar.reshape(-1, 3)))
    ours = measured_m(one).ravel()
    both = np.isfinite(ours) & np.isfinite(theirs)
    assert both.sum() > 250
    assert (np.isfinite(ours) != np.isfinite(theirs)).sum() <= 3
    assert np.percentile(np.abs(ours - theirs)[both], 98) < 2e-4
    frozen = Open3dLidar(case.target).cast([poses[0]] * len(poses), np.array(beams.directions_lidar.reshape(-1, 3)))[0]
    assert np.median(np.abs(frozen - ours)[both & np.isfinite(frozen)]) > 0.01  # the control: one pose for all is far off


def test_deskewed_truth_undoes_the_motion():
    """Points of a scan of a turning target lie on it at the middle of the scan; the points as measured do not."""
    case = _moving(RASTER, **TURNING)
    scene = realize(case, 0, 3)
    one = Scanner(case, NAME).take(scene)
    lidar_from_chaser = case.lidars[NAME].mount.chaser_from_cam.inv()
    target_from_lidar = (lidar_from_chaser * scene.pose_at(scene.time_s - 0.3)).inv()
    seen = np.isfinite(one.scan.intensity)
    distance_m = [
        _distance_m(case.target, target_from_lidar.apply(points[seen].astype(np.float64)))
        for points in (one.beams["deskewed_m"], one.scan.points_lidar)
    ]
    assert distance_m[0].max() < 1e-4
    assert np.median(distance_m[1]) > 0.01


def _distance_m(target: Target, points_target: Floats) -> Floats:
    """Distance of points from the target's surface."""
    scene = o3d.t.geometry.RaycastingScene()
    for solid in solids(target):
        scene.add_triangles(
            o3d.core.Tensor(solid.vertices_target.astype(np.float32)), o3d.core.Tensor(solid.faces.astype(np.uint32))
        )
    return np.asarray(scene.compute_distance(o3d.core.Tensor(points_target.astype(np.float32))).numpy(), np.float64)


def test_the_reference_pose_and_the_frame_s_pose_are_both_in_the_row():
    case = _moving(RASTER, **TURNING)
    scene = realize(case, 0, 3)
    row = Scanner(case, NAME).take(scene).truth
    lidar_from_chaser = case.lidars[NAME].mount.chaser_from_cam.inv()
    for prefix, at in (("", 0.0), ("scan_", -0.3)):
        wanted = lidar_from_chaser * scene.pose_at(scene.time_s + at)
        found = Rotation.from_quat([row[f"{prefix}q{axis}"] for axis in "xyzw"])
        assert (found * wanted.rotation.inv()).magnitude() < 1e-12
        assert [row[f"{prefix}t{axis}_m"] for axis in "xyz"] == pytest.approx(wanted.translation.tolist(), abs=1e-12)


def test_a_flash_of_a_still_target_has_its_points_where_they_are():
    case = _moving({"type": "flash", "columns": 40, "rows": 40, "field_deg": (14.0, 14.0)})
    one = sounding(case)
    seen = np.isfinite(one.scan.intensity)
    # A beam's axis and its points are one line: the measured point is the true one where nothing is noisy.
    assert np.abs(one.beams["deskewed_m"] - one.scan.points_lidar)[seen].max() < 1e-5


def test_no_sub_ray_slips_between_triangles():
    """A plate of two triangles whose shared edge runs through the middle of a symmetric flash."""
    for distance_m in (3.0, 5.0, 40.0):
        plate = box((20.0, 20.0, 0.2), LAMBERT, centre_m=(0.0, 0.0, 0.1))
        field = {"type": "flash", "columns": 65, "rows": 65, "field_deg": (0.5, 0.5)}
        case = scenario([plate], lidar(PAPER, pattern=field), still(distance_m))
        echoes = Scanner(case, NAME).echoes(realize(case, 0, 0))
        assert (echoes.cosine > 0).all()
        assert (echoes.part == 1).all()


def test_a_scan_of_nothing_is_a_scan():
    field = {"type": "flash", "columns": 8, "rows": 6, "field_deg": (1.0, 1.0)}
    one = sounding(scenario([box((1.0, 1.0, 1.0), LAMBERT)], lidar(pattern=field), still(-10.0)))
    assert one.scan.intensity.shape == (6, 8)
    assert np.isnan(one.scan.points_lidar).all()
    assert np.isfinite(one.scan.time_s).all()
    assert one.truth["returns"] == 0
