"""TOML in, a validated model out; every fault at once, in sentences that name file, key path and both values."""

import importlib.util
import os
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from pydantic import Discriminator, Field, Tag

from scenes.config import list_library, load, parse_override
from scenes.config_files import KINDS, LIBRARY, contained, folder_of, read_toml
from scenes.config_tree import Source, Table, assigned, refined, shown, tabled
from scenes.errors import ConfigError, UsageError
from scenes.scenario import load_scenario
from scenes.spec import Positive, Spec

_SPEC = importlib.util.spec_from_file_location("bad_scenarios", Path(__file__).with_name("bad_scenarios.py"))
bad_scenarios = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(bad_scenarios)


def fill(folder: Path, files: dict[str, bytes]) -> Path:
    """Writes files and returns the folder."""
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    return folder


class Lens(Spec):
    type: Literal["lens"] = "lens"
    description: str = ""
    focal_m: Positive
    blades: int = 5


class Mirror(Spec):
    type: Literal["mirror"]
    description: str = ""
    radius_m: Positive
    tilt_deg: tuple[float, float] = (0.0, 0.0)


def _kind(value):
    return value.get("type", "lens") if isinstance(value, dict) else value.type


class Telescope(Spec):
    name: str = ""
    elements: tuple[Annotated[Lens | Mirror, Field(discriminator="type")], ...] = ()
    finder: Lens | None = None
    guide: Annotated[Annotated[Lens, Tag("lens")] | Annotated[Mirror, Tag("mirror")], Discriminator(_kind)] | None = None
    extra: dict[str, Any] = Field(default_factory=dict)


class Hall(Spec):
    parts: Annotated[tuple[Lens, ...], Field(min_length=1)]


REFERENCES = {"elements.*": "cameras", "finder": "cameras"}


@pytest.fixture
def library(tmp_path):
    return fill(
        tmp_path / "library",
        {
            "cameras/big-lens.toml": '# a big lens\ntype = "lens"\nfocal_m = 2.0\nblades = 9\n',
            "cameras/flat-mirror.toml": 'description = "flat"\ntype = "mirror"\nradius_m = 9e9\n',
            "cameras/tilted-mirror.toml": 'base = "flat-mirror"\ntilt_deg = [1, 2]\n',
            "cameras/deep/inner.toml": "",
            "targets/newton.toml": 'name = "Newton"\nelements = ["flat-mirror", { base = "big-lens", blades = 3 }]\n',
        },
    )


def telescope(library, where, overrides=()):
    return load("target", str(where), Telescope, overrides, references=REFERENCES, library=library)


class TestBadInput:
    def test_the_good_scenario_is_good(self, tmp_path):
        fill(tmp_path, bad_scenarios.Bad("good", ()).folder())
        scenario = load_scenario(str(tmp_path / "scenario.toml"))
        assert scenario.rate_hz == 2.0
        assert scenario.target.parts[1].shape.path == str(tmp_path / "dish.obj")

    @pytest.mark.parametrize("bad", bad_scenarios.TABLE, ids=lambda bad: bad.name.replace(" ", "-"))
    def test_message(self, bad, tmp_path):
        fill(tmp_path, bad.folder())
        with pytest.raises(ConfigError) as caught:
            load_scenario(str(tmp_path / "scenario.toml"), bad.overrides)
        message = str(caught.value)
        for text in bad.says:
            assert text in message
        assert caught.value.exit_status == 2
        assert "\n" not in "".join(caught.value.faults)
        assert "Traceback" not in message

    def test_all_faults_come_at_once(self, tmp_path):
        wrong = ("frame_count=0", "rate_hz=nan", "motion.range_m=-1", "cameras.nav=nonesuch", "lights.sun.directoin=[0,0,1]", "x")
        fill(tmp_path, bad_scenarios.Bad("good", ()).folder())
        with pytest.raises(ConfigError) as caught:
            load_scenario(str(tmp_path / "scenario.toml"), wrong)
        assert len(caught.value.faults) == len(wrong)

    def test_a_list_with_a_bad_entry_is_not_called_too_short(self, tmp_path):
        (tmp_path / "my.toml").write_text('parts = [{ focal_m = "1" }]')
        with pytest.raises(ConfigError) as caught:
            load("target", str(tmp_path / "my.toml"), Hall)
        assert caught.value.faults == (f"{tmp_path}/my.toml: parts.0.focal_m: got '1' (a string), must be a number",)
        (tmp_path / "my.toml").write_text("parts = []")
        with pytest.raises(ConfigError, match=r"parts: got \[\], must have at least 1 entries"):
            load("target", str(tmp_path / "my.toml"), Hall)

    def test_a_union_that_is_told_apart_by_a_function(self, library):
        assert telescope(library, "newton", ["guide={focal_m=1.0}"]).guide == Lens(focal_m=1.0)
        for value, text in [
            ('{type="miror"}', "--set: guide.type: got 'miror', must be one of lens, mirror; did you mean 'mirror'?"),
            ('{focal="1"}', "--set: guide.focal: no such key; did you mean 'focal_m'?"),
            ('{focal_m="1"}', "--set: guide.focal_m: got '1' (a string), must be a number"),
        ]:
            with pytest.raises(ConfigError) as caught:
                telescope(library, "newton", [f"guide={value}"])
            assert text in str(caught.value)

    def test_a_fault_is_told_once_however_many_overrides_follow(self, tmp_path):
        fill(tmp_path, bad_scenarios.Bad("good", ()).folder())
        (tmp_path / "dish.obj").unlink()
        with pytest.raises(ConfigError) as caught:
            load_scenario(str(tmp_path / "scenario.toml"), ("rate_hz=1", "seed=2", "cameras.nav=guppy-f125c", "seed=3"))
        assert len(caught.value.faults) == 2

    def test_an_error_names_the_file_the_value_stands_in(self, library, tmp_path):
        (library / "cameras/big-lens.toml").write_text('type = "lens"\nfocal_m = -2.0\nblades = 9')
        (tmp_path / "my.toml").write_text('finder = { base = "big-lens", blades = 1.5 }\nelements = ["big-lens"]')
        with pytest.raises(ConfigError) as caught:
            telescope(library, tmp_path / "my.toml")
        assert set(caught.value.faults) == {
            "library/cameras/big-lens.toml: elements.0.focal_m: got -2.0, must be greater than 0",
            "library/cameras/big-lens.toml: finder.focal_m: got -2.0, must be greater than 0",
            f"{tmp_path}/my.toml: finder.blades: got 1.5 (a number), must be a whole number",
        }

    @pytest.mark.parametrize(
        ("path", "text"), [("", "it is a directory"), ("pipe.toml", "a device or a pipe"), ("no.toml", "no such file")]
    )
    def test_what_is_no_file(self, tmp_path, path, text):
        os.mkfifo(tmp_path / "pipe.toml")
        with pytest.raises(ConfigError, match=text):
            load_scenario(str(tmp_path / path))

    @pytest.mark.parametrize("name", ["", "..", "a\x00b", "./a\x00b.toml", "x" * 5000 + ".toml", "nonesuch"])
    def test_names_that_are_none(self, name):
        with pytest.raises(ConfigError):
            load_scenario(name)

    def test_what_may_not_be_read(self, tmp_path, monkeypatch):
        (tmp_path / "my.toml").write_text("")

        def refuse(_path):
            raise PermissionError(13, "Permission denied")

        monkeypatch.setattr(Path, "read_bytes", refuse)
        with pytest.raises(ConfigError, match=r"my\.toml: cannot read it: Permission denied"):
            load_scenario(str(tmp_path / "my.toml"))


class TestReferences:
    def test_a_name_is_the_entry_and_base_refines_it(self, library):
        newton = telescope(library, "newton", ["finder=big-lens"])
        assert newton.elements == (Mirror(type="mirror", description="flat", radius_m=9e9), Lens(focal_m=2.0, blades=3))
        assert newton.finder == Lens(focal_m=2.0, blades=9)

    def test_an_entry_may_itself_refine_another(self, library, tmp_path):
        (tmp_path / "my.toml").write_text('base = "newton"\nname = "mine"\nelements = [{ base = "tilted-mirror", radius_m = 3 }]')
        mine = telescope(library, tmp_path / "my.toml")
        assert mine.name == "mine"
        assert mine.elements == (Mirror(type="mirror", description="flat", radius_m=3, tilt_deg=(1, 2)),)

    def test_a_path_is_relative_to_the_file_it_stands_in(self, library, tmp_path):
        files = {
            "a/my.toml": 'finder = "parts/lens.toml"',
            "a/parts/lens.toml": 'base = "./blank.toml"\nfocal_m = 1',
            "a/parts/blank.toml": "blades = 4",
        }
        fill(tmp_path, files)
        assert telescope(library, tmp_path / "a/my.toml").finder == Lens(focal_m=1, blades=4)

    def test_a_path_of_the_command_line_is_relative_to_where_one_stands(self, library, tmp_path, monkeypatch):
        fill(tmp_path, {"here/lens.toml": "focal_m = 5.0"})
        monkeypatch.chdir(tmp_path / "here")
        assert telescope(library, "newton", ["finder=lens.toml"]).finder.focal_m == 5.0
        assert telescope(library, "newton", ["finder=./lens.toml", "finder.blades=2"]).finder == Lens(focal_m=5.0, blades=2)

    def test_a_string_elsewhere_is_a_string(self, library):
        assert telescope(library, "newton", ["extra.a=big-lens", 'name="./x.toml"']).extra == {"a": "big-lens"}

    def test_another_type_replaces_and_does_not_mix(self):
        source = Source("x", Path(), None)
        old = tabled({"e": {"type": "fixed", "time_s": 1.0}, "keep": 1, "d": {"a": 1, "b": 2}}, source)
        by = tabled({"e": {"type": "auto"}, "d": {"b": 3}}, source)
        assert refined(old, by) == {"e": {"type": "auto"}, "keep": 1, "d": {"a": 1, "b": 3}}
        assert old["d"] == {"a": 1, "b": 2}

    def test_unknown_kinds_are_a_programming_error(self, library):
        with pytest.raises(ValueError, match="did you mean 'camera'"):
            load("camra", "x", Lens, library=library)
        assert [folder_of(kind) for kind in ("study", "studies", "camera", "cameras")] == [
            "studies",
            "studies",
            "cameras",
            "cameras",
        ]


class TestOverrides:
    @pytest.mark.parametrize(
        ("text", "value"),
        [
            ("a=1", 1),
            ("a = 1.5 ", 1.5),
            ("a=true", True),
            ("a=[1, 2]", [1, 2]),
            ("a={x=1}", {"x": 1}),
            ("a='quoted'", "quoted"),
            ("a=bare-word", "bare-word"),
            ("a=b=c", "b=c"),
            ("a=1\nb=2", "1\nb=2"),  # smuggles no second key in
            ('a=""', ""),
            ("a=" + "[" * 9999, "[" * 9999),
        ],
    )
    def test_value_as_in_toml_else_a_string(self, text, value):
        assert parse_override(text) == (["a"], value)

    @pytest.mark.parametrize("text", ["", "a", "=1", "a..b=1", ".a=1"])
    def test_what_is_no_override(self, text):
        with pytest.raises(UsageError, match=r"not of the form key\.path=value"):
            parse_override(text)

    def test_later_ones_win_and_lists_have_places(self, library):
        done = telescope(
            library,
            "newton",
            ["elements.1.blades=7", "elements.1.blades=8", "elements.0.tilt_deg=[0, 0]", "elements.0.tilt_deg.1=0.5"],
        )
        assert done.elements[1].blades == 8
        assert done.elements[0].tilt_deg == (0.0, 0.5)

    def test_a_base_that_would_say_nothing_is_refused(self, library, tmp_path):
        (tmp_path / "my.toml").write_text('finder = "big-lens"')
        for where, key in [(tmp_path / "my.toml", "finder"), ("newton", "elements.1")]:
            with pytest.raises(ConfigError) as caught:
                telescope(library, where, [f"{key}.base=tilted-mirror"])
            assert caught.value.faults == (
                f"--set '{key}.base=tilted-mirror': what its base says is read already; "
                f"to take another entry, write --set {key}=tilted-mirror",
            )
        (tmp_path / "my.toml").write_text('name = "bare"')
        for order in [("finder.base=big-lens", "finder.blades=3"), ("finder.blades=3", "finder.base=big-lens")]:
            assert telescope(library, tmp_path / "my.toml", order).finder == Lens(focal_m=2.0, blades=3)

    def test_the_tree_before_is_not_changed(self):
        source = Source("x", Path(), None)
        tree = tabled({"a": {"b": [1, {"c": 2}]}}, source)
        assert assigned(tree, ["a", "b", "1", "c"], 3, source) == {"a": {"b": (1, {"c": 3})}}
        assert tree == {"a": {"b": (1, {"c": 2})}}


class TestContainment:
    def test_a_link_that_leads_out_is_refused(self, library, tmp_path):
        fill(
            tmp_path,
            {
                "outside/lens.toml": "focal_m = 1",
                "mine/my.toml": 'finder = "link.toml"',
                "mine/own.toml": 'finder = "dir/lens.toml"',
            },
        )
        (tmp_path / "mine/link.toml").symlink_to(tmp_path / "outside/lens.toml")
        (tmp_path / "mine/dir").symlink_to(tmp_path / "outside")
        for name in ("my", "own"):
            with pytest.raises(
                ConfigError, match=rf"{name}\.toml: finder: '.*' leads to .*outside/lens\.toml, outside of .*/mine;"
            ):
                telescope(library, tmp_path / f"mine/{name}.toml")

    def test_a_link_that_stays_inside_is_followed(self, library, tmp_path):
        fill(tmp_path, {"mine/my.toml": 'finder = "link.toml"', "mine/parts/lens.toml": "focal_m = 1"})
        (tmp_path / "mine/link.toml").symlink_to("parts/lens.toml")
        assert telescope(library, tmp_path / "mine/my.toml").finder.focal_m == 1

    def test_what_the_command_line_names_may_lie_anywhere(self, library, tmp_path):
        fill(tmp_path, {"outside/lens.toml": "focal_m = 1", "mine/my.toml": ""})
        found = telescope(library, tmp_path / "mine/my.toml", [f"finder={tmp_path}/outside/lens.toml"])
        assert found.finder.focal_m == 1

    def test_but_what_that_file_names_may_not(self, library, tmp_path):
        fill(tmp_path, {"outside/lens.toml": 'base = "../mine/base.toml"', "mine/my.toml": "", "mine/base.toml": "focal_m = 1"})
        with pytest.raises(ConfigError, match=r"--set: finder: '.*base\.toml' leads to .*, outside of"):
            telescope(library, tmp_path / "mine/my.toml", [f"finder={tmp_path}/outside/lens.toml"])

    def test_the_library_does_not_reach_out(self, library, tmp_path):
        (tmp_path / "lens.toml").write_text("focal_m = 1")
        (library / "targets/bad.toml").write_text('finder = "../../lens.toml"')
        with pytest.raises(ConfigError, match="outside of"):
            telescope(library, "bad")

    def test_contained(self, tmp_path):
        (tmp_path / "in").mkdir()
        assert contained(tmp_path / "in/../in/x", tmp_path / "in") == tmp_path / "in/x"
        for wrong in ("../x", "/etc", "../in-too"):
            with pytest.raises(ConfigError):
                contained(tmp_path / "in" / wrong, tmp_path / "in")


class TestLibrary:
    def test_listed_with_what_they_are_and_without_validation(self, library):
        (library / "cameras/broken.toml").write_text("= 1")
        listed = list_library("camera", library)
        assert listed.pop("broken").startswith("cannot be read: broken.toml: it is not valid TOML")
        assert listed == {"big-lens": "a big lens", "flat-mirror": "flat", "tilted-mirror": ""}
        assert list_library("studies", library) == {}

    @pytest.mark.parametrize("kind", KINDS)
    def test_every_entry_of_our_own_says_what_it_is(self, kind):
        assert all(text and not text.startswith("cannot") for text in list_library(kind).values())

    @pytest.mark.parametrize("name", list_library("scenario"))
    def test_every_scenario_of_our_own_is_valid(self, name):
        assert load_scenario(name).frame_count > 0

    def test_files_of_windows_editors_are_read(self, tmp_path):
        (tmp_path / "my.toml").write_bytes(b"\xef\xbb\xbfa = 1\r\n")
        assert read_toml(tmp_path / "my.toml", Source("my.toml", tmp_path, None)) == {"a": 1}
        assert LIBRARY.is_dir()


def test_values_are_shown_as_in_toml_and_short():
    source = Source("x", Path(), None)
    assert [shown(value) for value in (True, "a", 1.5, (1, "b"), Table(source), tabled({"a": 1}, source))] == [
        "true",
        "'a'",
        "1.5",
        "[1, 'b']",
        "an empty table",
        "a table of a",
    ]
    assert len(shown("x" * 1000)) == 80
    assert shown(tuple(range(100))) == "[0, 1, 2, 3, 4, 5, 6, 7, ...]"
