"""Methods by name: listed without being imported, errors that help."""

import subprocess
import sys

import pytest

from estimators import registry
from estimators.api import Estimator
from estimators.mono_rectangle.tracked import TrackedRectangle
from scenes.errors import UsageError


def test_ours_come_through_the_door():
    assert {"mono-rectangle", "mono-rectangle-paper"} <= set(registry.names())
    for name in ("mono-rectangle", "mono-rectangle-paper"):
        assert isinstance(registry.load(name), Estimator)


def test_listing_imports_no_method():
    loaded = "{'cv2', 'estimators.mono_rectangle'} & set(sys.modules)"
    code = f"import sys; from estimators import registry; registry.names(); print({loaded})"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.strip() == "set()"


def test_a_class_by_its_path_and_parameters():
    method = registry.load("estimators.mono_rectangle.tracked:TrackedRectangle", filter=True)
    assert isinstance(method, TrackedRectangle)
    assert method.parameters.filter


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        ("mono-rectangel", {}, "no method is called 'mono-rectangel'; did you mean 'mono-rectangle'?"),
        ("nowhere.at.all:Thing", {}, "module 'nowhere.at.all' does not import: No module named 'nowhere'"),
        ("json:Decoder", {}, "module 'json' has no 'Decoder'"),
        ("json:", {}, "module 'json' has no ''"),
        ("json:__name__", {}, "'__name__' of module 'json' is not a class"),
        ("collections:OrderedDict", {}, "gives a OrderedDict, which has no start and step"),
        ("mono-rectangle", {"filtr": 1}, "refuses filtr: no such key; did you mean 'filter'? (got 1; allowed: "),
        ("mono-rectangle", {"min_support": 2}, "refuses min_support: got 2, must be at most 1"),
        ("mono-rectangle-paper", {"votes": "many"}, "refuses votes: got 'many' (a string), must be a whole number"),
        ("lidar-ekf", {"filter": {"noise": {"rotation": 1}}}, "filter.noise.rotation: no such key; did you mean 'rotation_rad2_s"),
        ("lidar-ekf", {"reference": "mapp"}, "got 'mapp', must be one of auto, model, map, first; did you mean 'map'?"),
        ("lidar-ekf", {"bridge": 1, "kind": "icp"}, "refuses kind: got 'icp', must be one of "),
    ],
)
def test_errors_are_one_sentence(name, parameters, message):
    with pytest.raises(UsageError) as caught:
        registry.load(name, **parameters)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_module_in_the_working_directory_is_found_and_shadows_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", [one for one in sys.path if one not in ("", str(tmp_path))])
    monkeypatch.chdir(tmp_path)
    text = "class Mine:\n    def start(self, knowledge): ...\n    def step(self, observation): ...\n"
    (tmp_path / "hardlight_test_method.py").write_text(text)
    (tmp_path / "json.py").write_text(text)
    for _ in range(2):
        assert type(registry.load("hardlight_test_method:Mine")).__module__ == "hardlight_test_method"
    assert sys.path.count(str(tmp_path)) == 1
    assert sys.path[-1] == str(tmp_path)
    with pytest.raises(UsageError, match="module 'json' has no 'Mine'"):
        registry.load("json:Mine")
