"""Suites with stereo cases: what a file may say of rings, rigs, granted radii and printed figures."""

from pathlib import Path

import pytest

from benchmark.suite import Suite, load_suite
from scenes.errors import ConfigError

GOOD = """
title = "t"
description = "d"
quality = "standard"
[methods.ours]
estimator = "stereo-ring"
radius = true
[[cases]]
name = "one"
scenario = "shu2020-exp1"
frames = "0:10"
quality = "draft"
features = ["ring"]
[[published_rings]]
case = "one"
source = "a paper"
f2f_position_cm = [0.009, 0.015, 0.038]
f2f_rotation_deg = [0.324, 0.2, 0.137]
cpu_s = 1.5
reason = "because"
"""


def _load(tmp_path: Path, text: str) -> Suite:
    path = tmp_path / "suite.toml"
    path.write_text(text, encoding="utf-8")
    return load_suite(str(path))


def test_a_stereo_suite_says_what_is_granted_printed_and_rendered(tmp_path: Path) -> None:
    suite = _load(tmp_path, GOOD)
    assert suite.methods["ours"].radius
    assert (suite.quality, suite.cases[0].quality) == ("standard", "draft")
    (printed,) = suite.published_rings
    assert (printed.f2f_position_cm, printed.cpu_s, printed.reason) == ((0.009, 0.015, 0.038), 1.5, "because")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('features = ["ring"]', 'features = ["marker-1"]', r"'marker-1' is a marker; methods are told of rectangles and circles"),
        ('features = ["ring"]', 'features = ["rign"]', r"no feature .* is called 'rign'; did you mean 'ring'\?"),
        ('features = ["ring"]', 'features = ["ring"]\nrig = "sterio"', r"no rig .* is called 'sterio'; did you mean 'stereo'\?"),
        (
            'scenario = "shu2020-exp1"',
            'scenario = { base = "zhai2014-in-plane", target = "small-satellite" }',
            r"'ring' is a circle, which two cameras measure, and the scenario has no rig",
        ),
        ('case = "one"', 'case = "two"', r"published: no case of this suite is called 'two'"),
        ("cpu_s = 1.5", "cpu_s = 0.0", r"published_rings.0.cpu_s: got 0.0, must be greater than 0"),
        ("[0.324, 0.2, 0.137]", "[0.324, 0.2]", r"published_rings.0.f2f_rotation_deg"),
        ('quality = "draft"', 'quality = "best"', r"cases.0.quality: got 'best', must be one of reference, standard, fast, draft"),
    ],
)
def test_each_mistake_is_a_sentence(tmp_path: Path, old: str, new: str, sentence: str) -> None:
    assert old in GOOD
    with pytest.raises(ConfigError, match=sentence):
        _load(tmp_path, GOOD.replace(old, new))
