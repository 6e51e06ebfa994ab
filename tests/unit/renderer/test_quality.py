from typing import get_args

import pytest

from renderer.integrator import MAX_SCATTERINGS
from renderer.quality import PRESETS, Preset
from scenes.scenario import Quality


def test_every_quality_that_a_scenario_may_name_has_a_preset():
    assert set(PRESETS) == set(get_args(Quality))


@pytest.mark.parametrize("name", PRESETS)
def test_samples_fill_a_net(name: str):
    preset = PRESETS[name]
    for samples in (preset.direct_samples, preset.indirect_samples):
        assert samples & (samples - 1) == 0
    assert preset.max_scatterings == MAX_SCATTERINGS


@pytest.mark.parametrize("samples", [20, 36, 2048])
def test_a_number_without_a_net_is_refused(samples: int):
    with pytest.raises(ValueError, match=f"{samples} direct samples fill no net"):
        Preset(samples, 0)
    assert Preset(20, 0, stratified=False).direct_samples == 20


def test_the_reference_is_never_filtered():
    assert not PRESETS["reference"].denoise_indirect
    assert PRESETS["reference"].direct_samples >= max(preset.direct_samples for preset in PRESETS.values())
