"""The true states that a filter is judged by, against the poses of the same scenario: two descriptions of one motion."""

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.filter_gauge import Gauge
from benchmark.filter_truth import TrueStates, mass_of, true_states
from scenes.inertia import inertia_of
from scenes.pose_columns import pose_columns
from scenes.scenario import Scenario, load_scenario

OWN = RigidTransform.from_components([0.7, -0.4, 1.1], Rotation.from_euler("xyz", [25.0, 60.0, -110.0], degrees=True))
STEP_S = 0.05


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load_scenario("song2017", ["frame_count=3"])


@pytest.fixture(scope="module")
def truth(scenario: Scenario) -> pd.DataFrame:
    """Rows at 39.95, 40 and 40.05 s of a LIDAR that is mounted as the paper's."""
    lidar_from_chaser, rows = scenario.lidars["lidar"].mount.chaser_from_cam.inv(), []
    for time_s in (40 - STEP_S, 40.0, 40 + STEP_S):
        pose = lidar_from_chaser * scenario.trajectory.chaser_from_target(time_s, 0, 0)
        rows.append(pose_columns(pose) | scenario.trajectory.truth_columns(time_s, 0))
    return pd.DataFrame(rows)


@pytest.fixture(scope="module")
def states(truth: pd.DataFrame, scenario: Scenario) -> TrueStates:
    return true_states(truth, scenario.model_dump(mode="json"), Gauge("own", OWN))


def _inertial_from_own(states: TrueStates, truth: pd.DataFrame, scenario: Scenario) -> Rotation:
    names = ["chaser_qw", "chaser_qx", "chaser_qy", "chaser_qz"]
    inertial_from_chaser = Rotation.from_quat(np.array(truth[names]), scalar_first=True)
    return inertial_from_chaser * scenario.lidars["lidar"].mount.chaser_from_cam.rotation * states.lidar_from_own


def test_the_angular_velocity_is_how_the_attitude_changes(states: TrueStates, truth: pd.DataFrame, scenario: Scenario) -> None:
    attitude = _inertial_from_own(states, truth, scenario)
    turned = (attitude[0].inv() * attitude[2]).as_rotvec() / (2 * STEP_S)
    np.testing.assert_allclose(states.omega_own[1], turned, atol=1e-7)
    assert np.linalg.norm(turned) > 0.02


def test_centre_of_mass_and_offset_add_up_to_the_targets_place(
    states: TrueStates, truth: pd.DataFrame, scenario: Scenario
) -> None:
    """l of Song et al. 2017, eq. (25), of the method's origin: R_HC r + R_PC ρ − T."""
    chaser_m = np.array(truth[[f"chaser_{axis}_m" for axis in "xyz"]])[1]
    radial = chaser_m / np.linalg.norm(chaser_m)
    normal = np.cross(chaser_m, np.array(truth[[f"chaser_v{axis}_m_s" for axis in "xyz"]])[1])
    normal = normal / np.linalg.norm(normal)
    inertial_from_lvlh = np.stack([radial, np.cross(normal, radial), normal], axis=1)
    chaser = Rotation.from_quat(np.array(truth[["chaser_qw", "chaser_qx", "chaser_qy", "chaser_qz"]])[1], scalar_first=True)
    chaser_from_lidar = scenario.lidars["lidar"].mount.chaser_from_cam
    in_chaser = chaser.inv().apply(inertial_from_lvlh @ states.rel_m[1])
    place = chaser_from_lidar.inv().apply(in_chaser) + states.lidar_from_own[1].apply(states.rho_own_m)
    origin = np.array(truth[["tx_m", "ty_m", "tz_m"]])[1] + (states.lidar_from_own[1] * OWN.rotation.inv()).apply(OWN.translation)
    np.testing.assert_allclose(place, origin, atol=1e-6)


def test_the_inertia_is_the_bodys_in_the_axes_of_the_answer(states: TrueStates, scenario: Scenario) -> None:
    mass = mass_of(scenario.model_dump(mode="json"))
    assert mass is not None
    turned = OWN.rotation.inv().as_matrix() @ mass.inertia_target @ OWN.rotation.as_matrix()
    np.testing.assert_allclose(inertia_of(states.inertia), turned * 3 / np.trace(turned), atol=1e-12)
    np.testing.assert_allclose(states.principal, [500.0, 1000.0, 1500.0])


def test_a_motion_without_an_orbit_leaves_the_servicer_at_rest() -> None:
    """Then the relative angular velocity is the inertial one, and there is no LVLH to place the target in."""
    spinning = {"omega_x_rad_s": 0.1, "omega_y_rad_s": 0.0, "omega_z_rad_s": 0.0}
    row = pose_columns(RigidTransform.from_translation([0.0, 0.0, 10.0])) | spinning
    states = true_states(pd.DataFrame([row]), {"target": {}}, Gauge("own", OWN))
    np.testing.assert_allclose(states.omega_own[0], OWN.rotation.inv().apply([0.1, 0.0, 0.0]))
    assert np.isnan(states.rel_m).all()
    assert states.scan_rotation is None
