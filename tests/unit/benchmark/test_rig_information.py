"""What the two pictures of a rig tell together, against differences of both pictures of a cloud of points."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from benchmark.information import table
from benchmark.information.fisher import AXES, bound
from benchmark.information.pictures import PictureBounds
from scenes.recording import StereoPair
from scenes.scenario import Scenario, load_scenario

_POINTS = np.random.default_rng(0).normal(size=(30, 3))
_LEFT = RigidTransform.from_components([0.3, -0.2, 12.0], Rotation.from_rotvec([0.4, -0.8, 0.3]))
_COINCIDENT = RigidTransform.identity()
_TOED_IN = RigidTransform.from_components([-1.5, 0.1, 0.2], Rotation.from_rotvec([0.02, 0.25, 0.01]))


def _pixels(camera_from_target: RigidTransform) -> np.ndarray:
    seen = camera_from_target.apply(_POINTS)
    return np.asarray(1000 * seen[:, :2] / seen[:, 2:]).ravel()


def _slopes(camera_from_left: RigidTransform, left_from_target: RigidTransform) -> np.ndarray:
    """(n, 6) ∂pixels/∂ξ of a camera where ξ moves the target in the axes of ``left_from_target``."""

    def at(xi: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(xi[:3]) * left_from_target.rotation
        return _pixels(camera_from_left * RigidTransform.from_components(left_from_target.translation + xi[3:], turned))

    return np.stack([(at(1e-6 * axis) - at(-1e-6 * axis)) / 2e-6 for axis in np.eye(6)], axis=1)


def _information(rows: np.ndarray) -> np.ndarray:
    return rows.T @ rows / 0.2**2


def _rows(monkeypatch: pytest.MonkeyPatch, right_from_left: RigidTransform, asked: list[str] | None = None) -> pd.DataFrame:
    """The table of a frame whose cameras see the points, each with ξ in its own axes."""
    poses = {"a-left": _LEFT, "a-right": right_from_left * _LEFT}

    class Seen:
        def __init__(self, scenario: Scenario, sensor: str, **how: object) -> None:
            self.pose = poses[sensor]

        def bounds(self, frame: int, exposure_s: float) -> PictureBounds:
            found = bound(_information(_slopes(RigidTransform.identity(), self.pose)))
            return PictureBounds(found, found, found, found, 1.5)

    monkeypatch.setattr(table, "PictureInformation", Seen)
    dataset: Any = SimpleNamespace(
        frames=[3],
        scenario=load_scenario("zhai2014-in-plane"),
        sensors={"a-left": None, "a-right": None},
        rigs={"a": StereoPair("a-left", "a-right", right_from_left)},
        lidars={},
        truth_table=lambda: pd.DataFrame({"frame": [3], "sensor": ["a-left"]}),
        state=lambda frame: {"exposure_s": {"a-left": 1e-3, "a-right": 1e-3}},
    )
    return table.bounds_table(dataset, sensors=asked).set_index("sensor")


def test_two_pictures_tell_what_a_fit_to_both_would_in_the_left_cameras_axes(monkeypatch: pytest.MonkeyPatch) -> None:
    found = table.informations(_rows(monkeypatch, _TOED_IN).loc[["a"]])[0]
    both = np.vstack([_slopes(RigidTransform.identity(), _LEFT), _slopes(_TOED_IN, _LEFT)])
    np.testing.assert_allclose(found, _information(both), rtol=1e-6, atol=1e-6 * np.abs(found).max())
    alone = _information(both[:60]) + _information(_slopes(RigidTransform.identity(), _TOED_IN * _LEFT))
    assert np.abs(alone - found).max() > 0.01 * np.abs(found).max()  # added without a change of axes they are something else


def test_two_cameras_in_one_place_halve_the_covariance(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = _rows(monkeypatch, _COINCIDENT)
    for axis in AXES:
        assert rows.loc["a", f"sigma_{axis}"] == pytest.approx(rows.loc["a-left", f"sigma_{axis}"] / np.sqrt(2))


def test_a_rig_alone_can_be_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    assert list(_rows(monkeypatch, _TOED_IN, ["a"]).index) == ["a"]
