"""The row of the truth table: pose, light, phase angle and spin, in the axes of the camera that took the picture."""

import numpy as np
import pytest
from oracles.studio import box, camera, scenario, still
from scipy.spatial.transform import RigidTransform, Rotation

from renderer.photograph import Photograph, Photographer
from scenes.scenario import Scenario, realize

PARTS = [box((2.0, 1.0, 0.5)), box((0.3, 0.3, 1.5), name="mast", centre_m=(0.6, 0.2, -0.5))]
SUN = {"direction": (0.5, -0.2, -1.0)}
MOUNT = {"position_m": (0.8, -0.3, 0.2), "rotation_vector_deg": (3.0, -7.0, 40.0)}


def _take(case: Scenario, frame: int = 0) -> Photograph:
    return Photographer(case, "cam").take(realize(case, 0, frame))


@pytest.fixture(scope="module")
def mounted() -> tuple[Scenario, Photograph]:
    """A camera that sits askew on the chaser, frame 2 of a spinning target."""
    motion = still(12.0, (15.0, 25.0, -10.0), omega_target_deg_s=(1.0, -2.0, 3.0), velocity_m_s=(0.05, 0.0, -0.1))
    case = scenario(PARTS, camera(128, 96, 250.0, 1e-4, mount=MOUNT), motion, sun=SUN, frame_count=3, quality="fast")
    return case, _take(case, 2)


def test_the_pose_is_the_cameras_own(mounted: tuple[Scenario, Photograph]):
    case, photo = mounted
    row = photo.truth
    chaser_from_cam = RigidTransform.from_components(
        MOUNT["position_m"], Rotation.from_rotvec(MOUNT["rotation_vector_deg"], degrees=True)
    )
    expected = chaser_from_cam.inv() * case.motion.chaser_from_target(2.0, 2, 0)
    stored = Rotation.from_quat([row["qx"], row["qy"], row["qz"], row["qw"]])
    assert (stored.inv() * expected.rotation).magnitude() < 1e-12
    assert row["qw"] >= 0
    assert (row["tx_m"], row["ty_m"], row["tz_m"]) == pytest.approx(expected.translation, abs=1e-12)
    assert row["range_m"] == pytest.approx(np.linalg.norm(expected.translation))


def test_light_and_phase_angle_are_in_the_cameras_axes(mounted: tuple[Scenario, Photograph]):
    _, photo = mounted
    row = photo.truth
    towards = np.array(SUN["direction"]) / np.linalg.norm(SUN["direction"])
    turned = Rotation.from_rotvec(MOUNT["rotation_vector_deg"], degrees=True).inv().apply(towards)
    assert (row["light_x"], row["light_y"], row["light_z"]) == pytest.approx(turned, abs=1e-12)
    to_camera = -np.array([row["tx_m"], row["ty_m"], row["tz_m"]]) / row["range_m"]
    assert row["phase_angle_deg"] == pytest.approx(np.degrees(np.arccos(turned @ to_camera)), abs=1e-9)
    spin = (row["omega_x_rad_s"], row["omega_y_rad_s"], row["omega_z_rad_s"])
    assert spin == pytest.approx(np.radians([1.0, -2.0, 3.0]))
    assert row["visible_fraction"] == 1.0
    assert row["exposure_s"] == photo.exposure_s == 1e-4


def test_a_mounted_camera_sees_what_an_unmounted_one_sees_of_a_moved_target(mounted: tuple[Scenario, Photograph]):
    _, photo = mounted
    row = photo.truth
    pose = Rotation.from_quat([row["qx"], row["qy"], row["qz"], row["qw"]])
    motion = still() | {
        "position_m": (row["tx_m"], row["ty_m"], row["tz_m"]),
        "rotation_vector_deg": tuple(pose.as_rotvec(degrees=True)),
    }
    sun = {"direction": (row["light_x"], row["light_y"], row["light_z"])}
    plain = _take(scenario(PARTS, camera(128, 96, 250.0, 1e-4), motion, sun=sun, quality="fast"))
    pictures = []
    for one in (photo, plain):
        full = np.zeros((2, 96, 128))
        full[:, *one.window.slices] = one.layers["part_id"], one.layers["direct_diffuse"]
        pictures.append(full)
    assert np.array_equal(pictures[0][0], pictures[1][0])
    assert pictures[0][1].sum() == pytest.approx(pictures[1][1].sum(), rel=2e-3)
    assert np.abs(pictures[0][1] - pictures[1][1]).mean() < 0.02 * pictures[1][1].mean()
