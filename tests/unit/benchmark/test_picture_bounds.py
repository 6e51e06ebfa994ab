"""A pose that noise of the rendering may hide is looked for once more; one in a black picture is not."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmark.information.pictures import FINER, Derivatives, PictureBounds, PictureInformation, bounds_of
from renderer import neighbours


def _seen(samples: int, brightness_e: float) -> PictureBounds:
    """Six pixels that each tell one parameter, behind noise that 16 samples leave and 64 do not."""
    signal, noise = np.eye(6), 2.0 * np.ones((6, 6)) * (samples < 64)
    mean = np.full(6, brightness_e)
    return bounds_of(Derivatives(signal + noise, signal - noise, mean, np.ones(6)), np.ones(6))


@pytest.fixture
def rendered(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The samples of every camera that is made, of which none renders."""
    made: list[int] = []
    monkeypatch.setattr(neighbours, "Neighbours", lambda _scenario, _sensor, samples: made.append(samples))
    return made


@pytest.mark.parametrize(("samples", "brightness_e", "asked"), [(16, 100.0, [16, 64]), (16, 0.0, [16]), (64, 100.0, [64])])
def test_a_hidden_pose_is_rendered_more_finely(
    rendered: list[int], monkeypatch: pytest.MonkeyPatch, samples: int, brightness_e: float, asked: list[int]
) -> None:
    monkeypatch.setattr(PictureInformation, "_bounds", lambda *_: _seen(rendered[-1], brightness_e))
    scenario = SimpleNamespace(sensors={"nav": SimpleNamespace(detector=None)})
    found = PictureInformation(scenario, "nav", samples).bounds(0, 1e-3)  # type: ignore[arg-type]
    assert rendered == asked
    assert found.known.is_determined == (asked[-1] == 64)
    assert FINER == 4
