"""Scenario files and overrides that are wrong, each with what the message must say. A table, used by several tests."""

from dataclasses import dataclass, field

GOOD = """
frame_count = 10
rate_hz = 2.0
target = "own-target.toml"

[cameras]
nav = "guppy-f125b"

[lights]
sun = "sun"

[motion]
type = "axis-sweep"
axis = "y"
start_deg = 0.0
rate_deg_s = 0.1
range_m = 100.0
"""
TARGET = """
description = "a box and a mesh"

[[parts]]
name = "box"
material = "white-paint"
shape = { type = "box", size_m = [1.0, 2.0, 3.0] }

[[parts]]
name = "dish"
material = "aluminium"
centre_m = [0.0, 0.0, 2.0]
shape = { type = "mesh", path = "dish.obj", scale = 0.001 }
"""
DISH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n"


@dataclass(frozen=True)
class Bad:
    """One wrong scenario: GOOD and its files with ``edits`` (file, old, new); ``says``: every text that must be there."""

    name: str
    says: tuple[str, ...]
    edits: tuple[tuple[str, str, str], ...] = ()
    files: dict[str, bytes] = field(default_factory=dict)
    overrides: tuple[str, ...] = ()

    def folder(self) -> dict[str, bytes]:
        """File name → content."""
        texts = {"scenario.toml": GOOD, "own-target.toml": TARGET, "dish.obj": DISH}
        for name, old, new in self.edits:
            assert old in texts[name], f"{old!r} does not stand in {name}"
            texts[name] = texts[name].replace(old, new)
        return {name: text.encode() for name, text in texts.items()} | self.files


def _in(name: str, old: str, new: str) -> tuple[tuple[str, str, str], ...]:
    return ((name, old, new),)


SCENARIO, OWN = "scenario.toml", "own-target.toml"
TABLE = (
    Bad(
        "misspelt key",
        ("scenario.toml: rate_hertz: no such key; did you mean 'rate_hz'?", "got 2.0"),
        _in(SCENARIO, "rate_hz", "rate_hertz"),
    ),
    Bad(
        "misspelt key below",
        (
            "own-target.toml: target.parts.0.shape.size: no such key; did you mean 'size_m'?",
            "allowed: size_m, type",
            "parts.0.shape.size_m: it is missing",
        ),
        _in(OWN, "size_m", "size"),
    ),
    Bad(
        "key of another type",
        ("motion.velocity_m_s: no such key", "allowed: axis, range_m"),
        _in(SCENARIO, "range_m =", "velocity_m_s = [0, 0, 1]\nrange_m ="),
    ),
    Bad("number in quotes", ("scenario.toml: rate_hz: got '2.0' (a string), must be a number",), _in(SCENARIO, "2.0", '"2.0"')),
    Bad("true for a number", ("motion.range_m: got true (true or false), must be a number",), _in(SCENARIO, "100.0", "true")),
    Bad("broken number", ("frame_count: got 10.5 (a number), must be a whole number",), _in(SCENARIO, "10\n", "10.5\n")),
    Bad("list for a number", ("rate_hz: got [1, 2] (a list), must be a number",), _in(SCENARIO, "2.0", "[1, 2]")),
    Bad("table for a number", ("rate_hz: got a table of hz, must be a number",), _in(SCENARIO, "2.0", "{ hz = 2 }")),
    Bad("date for a number", ("rate_hz: got 2014-05-01, must be a number",), _in(SCENARIO, "2.0", "2014-05-01")),
    Bad(
        "number for a target",
        ("target: got 5 (a whole number), must be a table or a name",),
        _in(SCENARIO, '"own-target.toml"', "5"),
    ),
    Bad(
        "negative size",
        ("own-target.toml: target.parts.0.shape.size_m.1: got -2.0, must be greater than 0",),
        _in(OWN, "2.0, 3.0", "-2.0, 3.0"),
    ),
    Bad("zero frames", ("frame_count: got 0, must be at least 1",), _in(SCENARIO, "10\n", "0\n")),
    Bad("not a number", ("rate_hz: got nan, must be a finite number",), _in(SCENARIO, "2.0", "nan")),
    Bad("infinity", ("motion.range_m: got inf, must be a finite number",), _in(SCENARIO, "100.0", "inf")),
    Bad("short list", ("size_m: got [1.0, 2.0], an entry is missing in the list",), _in(OWN, "1.0, 2.0, 3.0", "1.0, 2.0")),
    Bad("long list", ("size_m: got [1.0, 2.0, 3.0, 4.0], must have at most 3 entries",), _in(OWN, "3.0]", "3.0, 4.0]")),
    Bad("missing key", ("scenario.toml: motion.range_m: it is missing",), _in(SCENARIO, "range_m = 100.0", "")),
    Bad("missing table", ("scenario.toml: motion: it is missing",), _in(SCENARIO, GOOD[GOOD.index("[motion]") :], "")),
    Bad("unknown choice", ("motion.axis: got 'w', must be one of x, y, z",), _in(SCENARIO, '"y"', '"w"')),
    Bad(
        "unknown type",
        (
            "shape.type: got 'bocks', must be one of box, crinkled-box, cylinder, tube, cone, dish, lathe, sphere, rubble, mesh; "
            "did you mean 'box'?",
        ),
        _in(OWN, '"box", size_m', '"bocks", size_m'),
    ),
    Bad("no type", ("shape: got a table of size_m, must have a key 'type'",), _in(OWN, 'type = "box", ', "")),
    Bad(
        "draw upside down",
        ("lights.sun.distance_au: high 0.5 lies below low 1.5",),
        _in(SCENARIO, 'sun = "sun"', 'sun = { base = "sun", distance_au = { draw = "uniform", low = 1.5, high = 0.5 } }'),
    ),
    Bad(
        "sun around the target",
        ("lights.sun: distance_au reaches down to 0.001, inside of the light: half_angle_deg ", "its radius 0.0046"),
        _in(SCENARIO, 'sun = "sun"', 'sun = { base = "sun", distance_au = 0.001 }'),
    ),
    Bad(
        "blind camera",
        ("cameras.nav.detector.quantum_efficiency: is zero from 300 to 1100 nm",),
        overrides=("cameras.nav.detector.quantum_efficiency=0",),
    ),
    Bad(
        "blind camera by a table",
        ("cameras.nav.detector.quantum_efficiency: is zero from 300 to 1100 nm",),
        overrides=("cameras.nav.detector.quantum_efficiency={wavelength_nm=[200, 250], value=[0.5, 0.0]}",),
    ),
    Bad(
        "endless exposure",
        ("cameras.nav.exposure.time_s: got 1000000000.0, must be at most 3600",),
        overrides=("cameras.nav.exposure.time_s=1e9",),
    ),
    Bad(
        "endless automatic exposure",
        ("cameras.nav.exposure.longest_s: got 3601, must be at most 3600",),
        overrides=("cameras.nav.exposure={type='auto', longest_s=3601}",),
    ),
    Bad(
        "word for a draw",
        ("lights.sun.distance_au: got 'near' (a string), must be a number or a table",),
        _in(SCENARIO, 'sun = "sun"', 'sun = { base = "sun", distance_au = "near" }'),
    ),
    Bad("two parts of one name", ("target: two parts are called 'box'",), _in(OWN, '"dish"', '"box"')),
    Bad("bad camera name", ("cameras.Nav 1: got 'Nav 1', must match ^[a-z]",), _in(SCENARIO, "nav =", '"Nav 1" =')),
    Bad(
        "no camera",
        ("a scenario needs at least one entry under cameras, rigs or lidars",),
        _in(SCENARIO, 'nav = "guppy-f125b"', ""),
    ),
    Bad(
        "duplicate key",
        ("scenario.toml: it is not valid TOML: cannot overwrite a value (at line 4",),
        _in(SCENARIO, "rate_hz = 2.0", "rate_hz = 2.0\nrate_hz = 3.0"),
    ),
    Bad("no TOML", ("scenario.toml: it is not valid TOML: ", "at line 3, column 11"), _in(SCENARIO, "2.0", "= 2.0")),
    Bad("no UTF-8", ("scenario.toml: it is not UTF-8 text (byte 3 is 0xff)",), files={SCENARIO: b"#  \xff"}),
    Bad("binary", ("scenario.toml: it is not valid TOML",), files={SCENARIO: bytes(200)}),
    Bad("nested without end", ("scenario.toml: it is nested too deeply",), files={SCENARIO: b"a = " + b"[" * 100_000}),
    Bad("a number without end", ("scenario.toml: it is not valid TOML",), files={SCENARIO: b"seed = " + b"9" * 10_000}),
    Bad(
        "too large",
        ("scenario.toml: cannot read it: it has 5000000 bytes, a TOML file has at most 4194304",),
        files={SCENARIO: b"#" * 5_000_000},
    ),
    Bad(
        "unknown camera",
        ("scenario.toml: cameras.nav: no entry of the library's cameras is called 'gupy-f125b'; did you mean 'guppy-f125b'?",),
        _in(SCENARIO, "guppy", "gupy"),
    ),
    Bad(
        "unknown material",
        (
            "own-target.toml: target.parts.0.material: no entry of the library's materials is called 'white'",
            "aluminium, aluminium-brushed, black-paint",
        ),
        _in(OWN, "white-paint", "white"),
    ),
    Bad(
        "name for a path",
        ("target: no entry of the library's targets is called 'own-target'", "the file beside it is called './own-target.toml'"),
        _in(SCENARIO, "own-target.toml", "own-target"),
    ),
    Bad(
        "unknown base",
        ("lights.sun: no entry of the library's lights is called 'son'; did you mean 'sun'?",),
        _in(SCENARIO, 'sun = "sun"', 'sun = { base = "son" }'),
    ),
    Bad(
        "base is no name",
        ("lights.sun: base is 5, must be a name of the library's lights or a path",),
        _in(SCENARIO, 'sun = "sun"', "sun = { base = 5 }"),
    ),
    Bad(
        "missing file",
        ("scenario.toml: target: ", "other.toml: there is no such file"),
        _in(SCENARIO, "own-target.toml", "other.toml"),
    ),
    Bad("broken file below", ("own-target.toml: it is not valid TOML", "scenario.toml: target: "), files={OWN: b"parts = ["}),
    Bad(
        "file names itself",
        ("'own-target.toml' names itself by way of scenario.toml and own-target.toml",),
        files={OWN: b'base = "own-target.toml"'},
    ),
    Bad(
        "file out of the folder",
        ("scenario.toml: target: '", "outside of ", "name it on the command line"),
        _in(SCENARIO, "own-target.toml", "../own-target.toml"),
    ),
    Bad(
        "absolute file",
        ("scenario.toml: target: '/etc/hosts.toml' leads to ", "outside of "),
        _in(SCENARIO, "own-target.toml", "/etc/hosts.toml"),
    ),
    Bad(
        "mesh out of the folder",
        ("own-target.toml: target.parts.1.shape.path: '", "outside of "),
        _in(OWN, "dish.obj", "../dish.obj"),
    ),
    Bad(
        "missing mesh",
        ("own-target.toml: target.parts.1.shape.path: ", "disc.obj: cannot read the mesh: No such file"),
        _in(OWN, "dish.obj", "disc.obj"),
    ),
    Bad(
        "mesh of no format",
        ("target.parts.1.shape.path: ", "'.toml' is no mesh format we read", ".glb, .obj, .ply, .stl"),
        _in(OWN, "dish.obj", "own-target.toml"),
    ),
    Bad(
        "broken mesh",
        ("target.parts.1.shape.path: ", "dish.obj: the mesh cannot be read, the file is broken"),
        files={"dish.obj": b"v 0 0 0\nf 1 2 3\n"},
    ),
    Bad("empty mesh", ("dish.obj: the mesh is empty or broken, it has 0 vertices",), files={"dish.obj": b""}),
    Bad(
        "not a number in a mesh",
        ("dish.obj: vertex 1 of the mesh is [nan, 0.0, 0.0]",),
        files={"dish.obj": DISH.replace("v 1 0 0", "v nan 0 0").encode()},
    ),
    Bad(
        "flat mesh",
        ("dish.obj: none of the mesh's 1 triangles has an area",),
        files={"dish.obj": b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"},
    ),
    Bad("override without value", ("--set 'rate_hz' is not of the form key.path=value",), overrides=("rate_hz",)),
    Bad("override with nothing", ("--set 'rate_hz=' gives no value",), overrides=("rate_hz=",)),
    Bad("override of a wrong key", ("--set: motion.rnge_m: no such key; did you mean 'range_m'?",), overrides=("motion.rnge_m=5",)),
    Bad(
        "override with a wrong value",
        ("--set: motion.range_m: got 'far' (a string), must be a number",),
        overrides=("motion.range_m=far",),
    ),
    Bad(
        "override through a number",
        ("--set 'rate_hz.x=1': rate_hz is 2.0, not a table, so it has no 'x'",),
        overrides=("rate_hz.x=1",),
    ),
    Bad(
        "override of a missing place",
        ("target.parts has 2 entries, 0 to 1; '2' is none of them",),
        overrides=("target.parts.2.name=a",),
    ),
    Bad(
        "override with an unknown name",
        ("--set: lights.sun: no entry of the library's lights is called 'moon'",),
        overrides=("lights.sun=moon",),
    ),
)
