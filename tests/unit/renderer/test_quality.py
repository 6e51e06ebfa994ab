import math
from typing import get_args

import pytest

from renderer.integrator import MAX_SCATTERINGS
from renderer.quality import PRESETS, Preset
from scenes.scenario import Quality


def test_every_quality_that_a_scenario_may_name_has_a_preset():
    assert set(PRESETS) == set(get_args(Quality))


@pytest.mark.parametrize("name", PRESETS)
def test_samples_fill_a_square_grid(name: str):
    preset = PRESETS[name]
    for samples in (preset.direct_samples, preset.indirect_samples):
        assert math.isqrt(samples) ** 2 == samples
        assert samples == 0 or samples % 37 != 0  # strata of time and cells of the pixel are paired by steps of 37
    assert preset.max_scatterings == MAX_SCATTERINGS


def test_a_number_without_a_grid_is_refused():
    with pytest.raises(ValueError, match="20 direct samples"):
        Preset(20, 0)
    assert Preset(20, 0, stratified=False).direct_samples == 20


def test_the_reference_is_never_filtered():
    assert not PRESETS["reference"].denoise_indirect
    assert PRESETS["reference"].direct_samples >= max(preset.direct_samples for preset in PRESETS.values())
