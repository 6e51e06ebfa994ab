import numpy as np
import pytest

from renderer.masks import Light, fractions, light_mask


def _mask(part: int = 1, *, saturated: bool = False, **layers: float) -> int:
    names = ("coverage", "facing", "unshadowed", "direct_diffuse", "direct_specular", "indirect")
    arrays = {name: np.full((1, 1), layers.get(name, 0.0), np.float32) for name in names}
    return int(light_mask(arrays, np.full((1, 1), part, np.uint32), np.full((1, 1), saturated))[0, 0])


@pytest.mark.parametrize(
    ("layers", "bits"),
    [
        pytest.param({"coverage": 1, "facing": 1, "unshadowed": 1, "direct_diffuse": 5}, Light.LIT, id="lit"),
        pytest.param({"coverage": 1}, Light.ATTACHED_SHADOW, id="turned away"),
        pytest.param({"coverage": 1, "facing": 1, "indirect": 2}, Light.CAST_SHADOW, id="something in between"),
        pytest.param({"coverage": 1, "facing": 1, "unshadowed": 0.6}, Light.LIT, id="mostly lit"),
        pytest.param({"coverage": 1, "facing": 1, "unshadowed": 0.4}, Light.CAST_SHADOW, id="mostly shadow"),
        pytest.param({"coverage": 0.6, "facing": 0.5, "unshadowed": 0.5}, Light.LIT, id="at the outline"),
        pytest.param(
            {"coverage": 0.6, "facing": 0.2, "unshadowed": 0.2}, Light.ATTACHED_SHADOW, id="an edge, mostly its dark side"
        ),
        pytest.param(
            {"coverage": 1, "facing": 1, "unshadowed": 1, "direct_diffuse": 2, "indirect": 2, "direct_specular": 5},
            Light.LIT | Light.SPECULAR,
            id="more glint than the rest",
        ),
        pytest.param(
            {"coverage": 1, "facing": 1, "unshadowed": 1, "direct_diffuse": 2, "indirect": 2, "direct_specular": 3},
            Light.LIT,
            id="less glint than the rest",
        ),
    ],
)
def test_one_pixel(layers: dict[str, float], bits: Light):
    assert _mask(**layers) == bits
    assert _mask(saturated=True, **layers) == bits | Light.SATURATED
    assert _mask(part=0, saturated=True, **layers) == 0


def test_fractions_count_the_targets_pixels():
    mask = np.array(
        [[0, Light.LIT, Light.LIT | Light.SPECULAR | Light.SATURATED], [0, Light.CAST_SHADOW, Light.ATTACHED_SHADOW]], np.uint32
    )
    expected = {"lit_fraction": 0.5, "shadow_fraction": 0.5, "specular_fraction": 0.25, "saturated_fraction": 0.25}
    assert fractions(mask) == expected


def test_without_target_there_are_no_fractions():
    assert all(np.isnan(value) for value in fractions(np.zeros((3, 3), np.uint32)).values())
