"""Lights, rigs and rings that are wrong: refused at load, the field named."""

import pytest

from scenes.errors import ConfigError
from scenes.scenario import load_scenario

LAMP, PANELS, RIG = "lights.lamp", "lights.room", "rigs.stereo"
BAD = {
    "a lamp that is its own aim": ("shu2020-exp3", [f"{LAMP}.aim_m=[-4.0, -1.0, 0.0]"], f"{LAMP}: aim_m"),
    "a lamp whose beam reaches behind it": ("shu2020-exp3", [f"{LAMP}.beam_deg=170.0"], "reaches behind the lamp"),
    "a lamp without power": ("shu2020-exp3", [f"{LAMP}.power_w=0.0"], f"{LAMP}.power_w"),
    "a lamp colder than red heat": ("shu2020-exp3", [f"{LAMP}.temperature_k=300.0"], f"{LAMP}.temperature_k"),
    "a ripple deeper than its power": ("shu2020-exp3", [f"{LAMP}.ripple_depth=1.5"], f"{LAMP}.ripple_depth"),
    "a lamp more than efficient": ("shu2020-exp3", [f"{LAMP}.efficiency=1.2"], f"{LAMP}.efficiency"),
    "no panels": ("shu2020-exp1", [f"{PANELS}.panels=[]"], f"{PANELS}.panels"),
    "a panel that faces nowhere": (
        "shu2020-exp1",
        [f"{PANELS}.panels=[{{ centre_m = [0, 0, 0], facing = [0, 0, 0], width_m = 1, height_m = 1 }}]"],
        "a zero vector has no direction",
    ),
    "an Earth that is not lit": ("ring-earthshine", ["lights.earth.sun_zenith_deg=95.0"], "lights.earth.sun_zenith_deg"),
    "an Earth brighter than white": ("ring-earthshine", ["lights.earth.albedo=1.2"], "lights.earth.albedo"),
    "an Earth that is black": ("ring-earthshine", ["lights.earth.albedo=0.0"], "there would be no light"),
    "panels of no colour": ("shu2020-exp1", [f"{PANELS}.relative_spectrum=0.0"], "there would be no light"),
    "panels of negative light": ("shu2020-exp1", [f"{PANELS}.relative_spectrum=-1.0"], "must not be negative"),
    "two lights and no key": ("shu2020-exp3", ["lights.earth=earth"], "key_light must name the one of earth, lamp"),
    "a key that is not there": ("ring-terminator", ["key_light=moon"], "no light is called 'moon'"),
    "a light that is none": ("shu2020-exp3", ["lights.lamp={ type = 'candle' }"], "'candle'"),
    "cameras that turn their backs": ("shu2020-exp1", [f"{RIG}.toe_in_deg=-40.0"], "their views do not overlap anywhere"),
    "a rig without a baseline": ("shu2020-exp1", [f"{RIG}.baseline_m=0.0"], f"{RIG}.baseline_m"),
    "a rig's camera with a mount": (
        "shu2020-exp1",
        [f"{RIG}.camera.mount={{ position_m = [1, 0, 0] }}"],
        "camera.mount must be left out",
    ),
    "a camera called as a rig's is": ("shu2020-exp1", ["cameras.stereo-left=lab-4mp"], "rigs.stereo has a camera 'stereo-left'"),
    "a rig of the library that is not there": ("shu2020-exp1", ["rigs.stereo=shu2020-rigg"], "shu2020-rig"),
    "a misspelt key": ("shu2020-exp1", [f"{RIG}.toe_in=9.0"], "toe_in_deg"),
    "a ring in no plane": ("shu2020-exp1", ["target.features.0.x_axis=[0, 0, 1]"], "normal and x_axis must be perpendicular"),
    "a nutation that turns over": ("shu2020-exp3", ["motion.nutation_deg=95.0"], "motion.nutation_deg"),
}


@pytest.mark.parametrize(("name", "overrides", "says"), BAD.values(), ids=BAD)
def test_it_is_refused_at_load_with_its_field(name: str, overrides: list[str], says: str):
    with pytest.raises(ConfigError) as refused:
        load_scenario(name, overrides)
    assert says in str(refused.value)
    assert "\n" not in refused.value.faults[0]


STEREO = ["shu2020-exp1", "shu2020-exp2", "shu2020-exp3", "ring-sun-glint", "ring-terminator", "ring-earthshine"]


@pytest.mark.parametrize("name", STEREO)
def test_the_librarys_stereo_scenarios_load(name: str):
    scenario = load_scenario(name)
    assert list(scenario.sensors) == ["stereo-left", "stereo-right"]
    assert "ring" in {feature.name for feature in scenario.target.features}
