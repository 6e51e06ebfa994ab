"""What people get wrong, through the real command line: one clear sentence, the right status, nothing written, nothing lost."""

import json
import os
import re
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

HEADER = "frame,sensor,outcome,qw,qx,qy,qz,tx_m,ty_m,tz_m,cpu_s,wall_s\n"
ROW = "0,nav,ok,1,0,0,0,,,,,\n"
SUITE = """
title = "t"
description = "d"
[methods.ours]
estimator = "mono-rectangle"
[[cases]]
name = "one"
scenario = "./tiny.toml"
frames = "0:2"
features = ["wing"]
"""


@dataclass
class Desk:
    """A folder to make mistakes in: copies of a good scenario, data set, suite and answers."""

    path: Path
    scenario: str
    source: Path

    @property
    def out(self) -> Path:
        """Where nothing must appear."""
        return self.path / "out"

    def toml(self, old: str = "", new: str = "") -> Path:
        """The good scenario with ``old`` replaced."""
        assert old in self.scenario
        return self.text("tiny.toml", self.scenario.replace(old, new, 1))

    def suite(self, old: str, new: str) -> Path:
        assert old in SUITE
        self.toml()
        return self.text("suite.toml", SUITE.replace(old, new, 1))

    def text(self, name: str, text: str) -> Path:
        path = self.path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def bytes(self, data: bytes) -> Path:
        path = self.path / "tiny.toml"
        path.write_bytes(data)
        return path

    def data(self) -> Path:
        """A copy of the good data set."""
        copy = self.path / "data"
        if not copy.exists():
            shutil.copytree(self.source, copy)
        return copy

    def answers(self, table: str = HEADER + ROW, **record: object) -> Path:
        """A folder of answers on the good data set."""
        identity = json.loads((self.source / "manifest.json").read_text())["identity"]
        full = {"format": "hardlight-predictions", "version": 1, "method": "mine", "dataset_identity": identity} | record
        self.text("answers/run.json", json.dumps({key: value for key, value in full.items() if value is not None}))
        return self.text("answers/predictions.csv", table).parent


Make = Callable[[Desk], list[object]]
CASES: dict[str, tuple[Make, int, str]] = {}


def case(name: str, status: int, sentence: str) -> Callable[[Make], Make]:
    """Registers a mistake: what it ends with and what it says."""

    def register(make: Make) -> Make:
        assert name not in CASES
        CASES[name] = (make, status, sentence)
        return make

    return register


def scenario_case(name: str, sentence: str, old: str, new: str) -> None:
    """A mistake in a scenario file."""
    case(name, 2, sentence)(lambda desk: ["render", desk.toml(old, new), "--out", desk.out])


def render_case(name: str, sentence: str, *arguments: object) -> None:
    """A mistake in the arguments of render."""
    case(name, 2, sentence)(lambda desk: ["render", desk.toml(), "--out", desk.out, *arguments])


def answers_case(name: str, sentence: str, table: str = HEADER + ROW, **record: object) -> None:
    """A mistake in a folder of answers."""
    case(name, 1, sentence)(lambda desk: ["judge", desk.answers(table, **record), desk.source, "--out", desk.out])


def suite_case(name: str, sentence: str, old: str, new: str) -> None:
    """A mistake in a suite file."""
    case(name, 2, sentence)(lambda desk: ["bench", desk.suite(old, new), "--out", desk.out])


# --- scenarios ---------------------------------------------------------------------------------------------------------
case("unknown scenario", 2, r"'zhai2014-in-plan'; did you mean 'zhai2014-in-plane'\?")(
    lambda desk: ["render", "zhai2014-in-plan", "--out", desk.out]
)
case("no such file", 2, r"nowhere\.toml")(lambda desk: ["render", desk.path / "nowhere.toml", "--out", desk.out])
case("a folder as scenario", 2, r"it is a directory, not a TOML file")(lambda desk: ["render", f"{desk.path}/", "--out", desk.out])
case("not TOML", 2, r"tiny\.toml.*line 2")(lambda desk: ["render", desk.text("tiny.toml", "a = 1\nb = = 2\n"), "--out", desk.out])
case("not UTF-8", 2, r"tiny\.toml: .*UTF-8")(lambda desk: ["render", desk.bytes(b"a = '\xff\xfe'"), "--out", desk.out])
scenario_case("misspelt key", r"frame_cuont: no such key; did you mean 'frame_count'\?", "frame_count", "frame_cuont")
scenario_case("misspelt nested key", r"cameras\.nav\.widht_px: no such key; did you mean 'width_px'\?", "width_px", "widht_px")
scenario_case("string for a number", r"frame_count: got 'six' \(a string\), must be a whole number", "= 6", '= "six"')
scenario_case("fraction of a frame", r"frame_count: got 6\.5 .*must be a whole number", "= 6", "= 6.5")
scenario_case("negative range", r"motion\.range_m: got -100\.0, must be greater than 0", "100.0", "-100.0")
scenario_case("zero frames", r"frame_count: got 0, must be at least 1", "= 6", "= 0")
scenario_case("NaN", r"motion\.range_m: .*must be a finite number", "100.0", "nan")
scenario_case("infinity", r"motion\.rate_deg_s: .*must be a finite number", "rate_deg_s = 1.0", "rate_deg_s = inf")
scenario_case("unknown target", r"target: .*'zhai2014-tarjet'; did you mean 'zhai2014-target'\?", "2014-target", "2014-tarjet")
scenario_case("unknown camera", r"cameras\.nav: .*'guppy-f125'; did you mean 'guppy-f125b'\?", '"guppy-f125b"', '"guppy-f125"')
scenario_case(
    "unknown motion", r"motion\.type: got 'axis-swep', must be one of .*did you mean 'axis-sweep'\?", "axis-sweep", "axis-swep"
)
scenario_case("unknown quality", r"quality: got 'drafty', must be one of reference, standard, fast, draft", '"draft"', '"drafty"')
scenario_case("missing key", r"motion\.range_m: it is missing", "range_m = 100.0", "")
scenario_case("key given twice", r"tiny\.toml", "frame_count = 6", "frame_count = 6\nframe_count = 7")
scenario_case(
    "no camera at all",
    r"at least one entry under cameras, rigs or lidars",
    '[cameras.nav]\nbase = "guppy-f125b"\nwidth_px = 640\nheight_px = 128',
    "[cameras]",
)
scenario_case("target outside its folder", r"outside", '"zhai2014-target"', '"../../../../etc/passwd.toml"')


MESH = """{ parts = [{ name = "hull", material = "white-paint", shape = { type = "mesh", path = "PATH" } }] }"""
for _name, _path, _sentence in (
    ("missing mesh", "hull.stl", r"target\.parts\.0\.shape\.path: .*hull\.stl"),
    ("mesh outside the scenario's folder", "../hull.stl", r"target\.parts\.0\.shape\.path: .*outside"),
    ("mesh by an absolute path", "/etc/hostname", r"target\.parts\.0\.shape\.path: .*outside"),
):
    scenario_case(_name, _sentence, '"zhai2014-target"', MESH.replace("PATH", _path))


@case("corrupt mesh", 2, r"target\.parts\.0\.shape\.path: .*hull\.stl")
def _corrupt_mesh(desk: Desk) -> list[object]:
    desk.text("hull.stl", "solid nothing\nfacet normal oops\n")
    return ["render", desk.toml('"zhai2014-target"', MESH.replace("PATH", "hull.stl")), "--out", desk.out]


# --- arguments of render -----------------------------------------------------------------------------------------------
render_case("frames outside", r"'0:7' lies outside the scenario, which has frames 0 to 5", "--frames", "0:7")
render_case("frames backward", r"selects no frame", "--frames", "4:2")
render_case("frames no numbers", r"'a' is not a whole number; write n, a:b or a:b:step", "--frames", "a:3")
render_case("frames of four parts", r"has 4 parts", "--frames", "0:1:2:3")
render_case("frames of step 0", r"a step is at least 1", "--frames", "0:6:0")
render_case("set without value", r"--set 'quality' is not of the form key\.path=value", "--set", "quality")
render_case("set an unknown key", r"qualty: no such key; did you mean 'quality'\?", "--set", "qualty=fast")
render_case("set a wrong type", r"frame_count: got 'many' \(a string\), must be a whole number", "--set", "frame_count=many")
render_case("set out of bounds", r"cameras\.nav\.f_number: got -8, must be greater than 0", "--set", "cameras.nav.f_number=-8")
render_case("negative seed", r"Invalid value for '--seed': got '-1', input should be greater than or equal to 0", "--seed", -1)
render_case("seed that is no number", r"Invalid value for '--seed': got 'x', input should be a valid integer", "--seed", "x")
render_case("no workers", r"Invalid value for '--workers': got '0', input should be greater than or equal to 1", "--workers", 0)
render_case("unknown preset", r"no quality preset is called 'fats'; did you mean 'fast'\?", "--quality", "fats")
render_case("unknown option", r"No such option: --frmes", "--frmes", "0:2")
case("no --out", 2, r"Missing option '--out'")(lambda desk: ["render", desk.toml()])
case("unknown verb", 2, r"No such command 'rendr'")(lambda desk: ["rendr", desk.toml(), "--out", desk.out])


# --- the output folder -------------------------------------------------------------------------------------------------
@case("out is a file", 2, r"it is a file, not a folder")
def _out_is_file(desk: Desk) -> list[object]:
    return ["render", desk.toml(), "--out", desk.text("taken", "x")]


@case("out holds other things", 2, r"it is no data set and not empty \(it has 'thesis\.tex'\)")
def _out_is_full(desk: Desk) -> list[object]:
    return ["render", desk.toml(), "--out", desk.text("work/thesis.tex", "precious").parent]


@case("out of another digest", 2, r"digest: [0-9a-f]{64} in the folder, [0-9a-f]{64} asked for")
def _out_of_another_digest(desk: Desk) -> list[object]:
    return ["render", desk.toml("start_deg = 20.0", "start_deg = 21.0"), "--out", desk.data(), "--resume"]


@case("out of another seed", 2, r"seed: 0 in the folder, 5 asked for")
def _out_of_another_seed(desk: Desk) -> list[object]:
    return ["render", desk.toml(), "--out", desk.data(), "--resume", "--seed", 5]


@case("out done already", 2, r"it holds this data set already; go on with --resume or choose another folder")
def _out_is_done(desk: Desk) -> list[object]:
    return ["render", desk.toml(), "--out", desk.data()]


# --- data sets ---------------------------------------------------------------------------------------------------------
def _harm(name: str, file: str, change: Callable[[bytes], bytes | None], sentence: str) -> None:
    """A data set with one file changed (None: deleted) is found out by verify."""

    def make(desk: Desk) -> list[object]:
        path = desk.data() / file
        changed = change(path.read_bytes())
        if changed is None:
            path.unlink()
        else:
            path.write_bytes(changed)
        return ["verify", desk.data(), "--sample", 0]

    case(name, 1, sentence)(make)


case("verify a folder that is no data set", 1, r"it is no data set, manifest\.json is missing")(
    lambda desk: ["verify", desk.path, "--sample", 0]
)
_harm("truncated picture", "frames/000002/nav.png", lambda data: data[:-100], r"000002/nav\.png")
_harm("edited picture", "frames/000002/nav.png", lambda data: data[:500] + b"x" + data[501:], r"000002/nav\.png: .*digest")
_harm("truncated truth layers", "frames/000003/nav_truth.exr", lambda data: data[:1000], r"000003/nav_truth\.exr")
_harm("edited frame.json", "frames/000001/frame.json", lambda data: data.replace(b"1.0", b"1.5", 1), r"000001/frame\.json")
_harm("deleted frame.json", "frames/000004/frame.json", lambda _: None, r"000004")
_harm("edited manifest", "manifest.json", lambda data: data.replace(b"20.0", b"25.0", 1), r"manifest\.json.*it was edited")
_harm("truncated manifest", "manifest.json", lambda data: data[:200], r"manifest\.json.*truncated or edited")
_harm("deleted truth table", "truth.parquet", lambda _: None, r"truth\.parquet")
_harm("truncated truth table", "truth.parquet", lambda data: data[:300], r"truth\.parquet")


@case("estimate an unfinished data set", 1, r"1 of 6 frames are missing \(000005\); render them with --resume")
def _unfinished(desk: Desk) -> list[object]:
    shutil.rmtree(desk.data() / "frames" / "000005")
    return ["estimate", "mono-rectangle", desk.data(), "--feature", "wing", "--out", desk.out]


@case("estimate a harmed picture", 1, r"000002/nav\.png: its digest is .*it was truncated or edited")
def _harmed(desk: Desk) -> list[object]:
    picture = desk.data() / "frames" / "000002" / "nav.png"
    picture.write_bytes(picture.read_bytes()[:-100])
    return ["estimate", "mono-rectangle", desk.data(), "--feature", "wing", "--out", desk.out]


# --- estimate ----------------------------------------------------------------------------------------------------------
def estimate_case(name: str, sentence: str, method: str, *arguments: object) -> None:
    """A mistake in the arguments of estimate."""
    case(name, 2, sentence)(lambda desk: ["estimate", method, desk.source, "--out", desk.out, *arguments])


WING = ("--feature", "wing")
OURS = "mono-rectangle"
estimate_case("unknown method", r"no method is called 'mono-rectangel'; did you mean 'mono-rectangle'\?", "mono-rectangel", *WING)
estimate_case("method whose module is not there", r"module 'nowhere' does not import", "nowhere:Class", *WING)
estimate_case("method whose class is not there", r"module 'json' has no 'Estimator'", "json:Estimator", *WING)
estimate_case("method that is no estimator", r"has no start and step|is not a class|refuses", "json:JSONDecoder", *WING)
estimate_case("unknown parameter", r"refuses fliter: no such key; did you mean 'filter'\?", OURS, *WING, "--set", "fliter=true")
estimate_case("impossible parameter", r"refuses min_support: got 2, must be at most 1", OURS, *WING, "--set", "min_support=2")
estimate_case("parameter and group", r"'a' was given a value of its own before", OURS, *WING, "--set", "a=1", "--set", "a.b=1")
estimate_case("unknown feature", r"no feature is called 'wnig'; did you mean 'wing'\?", OURS, "--feature", "wnig")
estimate_case("no feature named", r"choose one with --feature: face, wing, span", OURS)
estimate_case(
    "negative sigma",
    r"Invalid value for '--prior-sigma-px': got '-1', input should be greater",
    OURS,
    *WING,
    "--prior-sigma-px",
    -1,
)
estimate_case("sigma that is no number", r"Invalid value for '--prior-sigma-px': got 'nan'", OURS, *WING, "--prior-sigma-px", "nan")
estimate_case("infinite sigma", r"sigma is inf px; it must be a finite number", OURS, *WING, "--prior-sigma-px", "inf")


@case("answers over those of another run", 2, r"holds the answers of another run \(method: mine there, mono-rectangle now\)")
def _mixed(desk: Desk) -> list[object]:
    return ["estimate", OURS, desk.source, "--feature", "wing", "--out", desk.answers()]


@case("answers into a full folder", 2, r"is not empty and holds no run\.json; choose another folder")
def _into_full(desk: Desk) -> list[object]:
    return ["estimate", OURS, desk.source, "--feature", "wing", "--out", desk.text("work/thesis.tex", "precious").parent]


# --- judge -------------------------------------------------------------------------------------------------------------
case("answers that are not there", 1, r"run\.json does not exist")(
    lambda desk: ["judge", desk.path, desk.source, "--out", desk.out]
)
answers_case("wrong column", r"lacks the column 'qw' and has the unknown column 'w'", HEADER.replace("qw", "w") + ROW)
answers_case("empty table", r"lacks the column 'frame'", "")
answers_case("no line", r"the predictions have no line", HEADER)
answers_case("a line too short", r"line 2: 3 fields where the header has 12", HEADER + "0,nav,ok\n")
answers_case("NaN in a pose", r"line 2: qx is nan; leave the field empty", HEADER + ROW.replace("1,0,", "1,nan,", 1))
answers_case("quaternion of length 2", r"line 2: the quaternion has length 2, not 1", HEADER + ROW.replace("ok,1", "ok,2"))
answers_case("unknown outcome", r"no outcome is called 'okay'; did you mean 'ok'\?", HEADER + ROW.replace("ok", "okay"))
answers_case("frame answered twice", r"line 3: frame 0 of 'nav' is answered twice \(first on line 2\)", HEADER + ROW + ROW)
answers_case("pose without ok", r"outcome is diverged but the line gives a pose", HEADER + ROW.replace("ok", "diverged"))
answers_case("ok without pose", r"outcome is ok but qw is empty", HEADER + ROW.replace("1,0,0,0", ",,,"))
answers_case("frame that is not there", r"answer frame 77, which .* does not have", HEADER + ROW.replace("0,nav", "77,nav"))
answers_case("sensor that is not there", r"no sensor is called 'nva'; did you mean 'nav'\?", HEADER + ROW.replace("nav", "nva"))
answers_case("answers on another data set", r"made on data set abc, but .* is data set [0-9a-f]{64}", dataset_identity="abc")
answers_case("misspelt key of run.json", r"run\.json: paramters: Extra inputs", paramters={})
answers_case("missing key of run.json", r"run\.json: method: Field required", method=None)
answers_case("later version of run.json", r"run\.json: version: Input should be 1 \(found 2\)", version=2)

# --- bench, report, list -----------------------------------------------------------------------------------------------
case("unknown suite", 2, r"'zhai2041'; did you mean 'zhai2014'\?")(lambda desk: ["bench", "zhai2041", "--out", desk.out])
suite_case("misspelt key of a suite", r"cases\.0\.scenrio: no such key; did you mean 'scenario'\?", "scenario", "scenrio")
suite_case("suite with an unknown feature", r"'wnig'; did you mean 'wing'\?", '"wing"', '"wnig"')
suite_case("suite with frames outside", r"frames '0:9' lies outside the scenario", "0:2", "0:9")
suite_case("suite with an unknown scenario", r"cases\.0\.scenario: .*nowhere\.toml", "./tiny.toml", "./nowhere.toml")
suite_case("suite with a scenario outside", r"cases\.0\.scenario: .*outside", "./tiny.toml", "../../tiny.toml")
suite_case("suite without a method", r"at least one \[methods", '[methods.ours]\nestimator = "mono-rectangle"', "[methods]")


@case("bench over another data set", 2, r"it holds another data set and is left as it is")
def _bench_over_another(desk: Desk) -> list[object]:
    shutil.copytree(desk.source, desk.path / "done" / "datasets" / "one")
    return ["bench", desk.suite("", ""), "--out", desk.path / "done"]


case("report without results", 1, r"holds no results\.json; give the --out folder of hardlight bench, judge or demo")(
    lambda desk: ["report", desk.path]
)


@case("report on damaged results", 1, r"results\.json is damaged: ")
def _damaged_results(desk: Desk) -> list[object]:
    return ["report", desk.text("done/results.json", "{}").parent]


case("unknown kind of list", 2, r"no kind is called 'scenario'; did you mean 'scenarios'\?")(lambda _: ["list", "scenario"])


@pytest.fixture
def desk(tmp_path: Path, tiny_scenario: Path, tiny_dataset: Path) -> Desk:
    return Desk(tmp_path, tiny_scenario.read_text(encoding="utf-8"), tiny_dataset)


def _files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.mark.parametrize("name", CASES)
def test_a_mistake_is_a_sentence_and_leaves_everything_as_it_was(name: str, desk: Desk, hardlight: Callable[..., Any]) -> None:
    make, status, sentence = CASES[name]
    arguments = make(desk)
    before = _files(desk.path)
    ended = hardlight(*arguments)
    said = ended.err + (ended.out if arguments[0] == "verify" else "")
    assert ended.status == status, said
    assert re.search(sentence, said), said
    assert "Traceback" not in said
    assert "internal error" not in said
    assert len(said.splitlines()) <= 4, said
    assert _files(desk.path) == before
    assert not desk.out.exists()


def test_there_are_at_least_forty_mistakes() -> None:
    assert len(CASES) >= 40


def test_all_mistakes_of_a_file_are_told_at_once(desk: Desk, hardlight: Callable[..., Any]) -> None:
    text = desk.scenario.replace("frame_count = 6", "frame_count = 0").replace("= 100.0", "= -1.0").replace("width_px", "widht_px")
    ended = hardlight("render", desk.text("tiny.toml", text), "--out", desk.out)
    assert ended.status == 2
    for sentence in (r"frame_count: got 0", r"motion\.range_m: got -1\.0", r"cameras\.nav\.widht_px: no such key"):
        assert re.search(sentence, ended.err), ended.err


def _starved(desk: Desk, bytes_allowed: int, *arguments: object) -> subprocess.CompletedProcess[str]:
    """The command in a process that cannot write a file longer than ``bytes_allowed``: a disk that fills up."""
    return subprocess.run(
        [sys.executable, "-m", "benchmark.cli", *map(str, arguments)],
        check=False,
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_allowed, bytes_allowed)),
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
    )


def test_a_disk_that_fills_up_while_answers_are_written_leaves_the_old_ones(desk: Desk) -> None:
    out = desk.path / "answers"
    arguments = ("estimate", OURS, desk.source, "--feature", "wing", "--out", out, "--quiet")
    assert _starved(desk, 10_000_000, *arguments).returncode == 0
    before = _files(out)
    ended = _starved(desk, 700, *arguments)
    assert ended.returncode == 1
    assert re.search(r"hardlight estimate: cannot write to .*answers: File too large", ended.stderr), ended.stderr
    assert "Traceback" not in ended.stderr
    assert _files(out) == before


def test_a_disk_that_fills_up_while_a_frame_is_written_leaves_no_half_frame(desk: Desk) -> None:
    ended = _starved(desk, 20_000, "render", desk.toml(), "--out", desk.out, "--quiet")
    assert ended.returncode == 1
    assert "Traceback" not in ended.stderr
    assert len(ended.stderr.splitlines()) == 1, ended.stderr
    assert list(desk.out.glob("frames/*")) == []
