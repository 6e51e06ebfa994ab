"""What README.md and CONTRIBUTING.md show a newcomer is what works: their commands, their scenario, their program."""

import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pytest
import typer

from benchmark.cli import app
from scenes.dataset import Dataset
from scenes.scenario import load_scenario

PAGES = ("README.md", "CONTRIBUTING.md", "CONVENTIONS.md", "CHANGELOG.md")
OWN_VERBS = ("test",)  # of ./run; every other verb belongs to the command line
VERBS = typer.main.get_command(app).commands


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def commands(page: Path) -> Iterator[list[str]]:
    """The words after ``./run`` or ``hardlight`` of every command in a page's shell blocks and in its text."""
    text = page.read_text(encoding="utf-8")
    shown = [line for block in blocks(page, "sh") for line in block.splitlines()]
    for line in shown + re.findall(r"`((?:\./run|hardlight) [^`]+)`", text):
        words = shlex.split(line, comments=True)
        if words and words[0] in ("./run", "hardlight"):
            yield words[1:]


def parse(words: list[str]) -> None:
    """Raises unless the command line would take these words; runs nothing. A verb on its own is only named."""
    verb, *arguments = words
    command = VERBS[verb]
    if arguments:
        command.make_context(verb, arguments)


def counted(block: str) -> int:
    return len([line for line in block.splitlines() if line.strip()])


def hardlight(*words: str, cwd: Path) -> str:
    command = [sys.executable, "-c", "from benchmark.cli import main; main()", *words]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def readme(repository: Path) -> Path:
    return repository / "README.md"


@pytest.fixture(scope="module")
def mine(readme: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the README's scenario in it."""
    (block,) = blocks(readme, "toml")
    assert counted(block) <= 20
    folder = tmp_path_factory.mktemp("mine")
    (folder / "mine.toml").write_text(block, encoding="utf-8")
    return folder


@pytest.mark.parametrize("page", PAGES)
def test_the_commands_of_the_pages_exist(repository, page):
    for words in commands(repository / page):
        if words[0] not in OWN_VERBS:
            parse(words)


def test_the_two_commands_are_there(readme):
    assert [words[0] for words in commands(readme)][:2] == ["demo", "test"]


@pytest.mark.parametrize("words", [["rendr", "x"], ["render", "x", "--out", "y", "--frame", "3"], ["judge", "x"]])
def test_a_command_that_does_not_exist_would_be_found(words):
    with pytest.raises(Exception, match=r"rendr|No such option|Missing"):
        parse(words)


@pytest.mark.parametrize("verb", sorted(VERBS))
def test_every_verb_shows_an_example_that_parses(verb):
    examples = re.findall(r"hardlight (.+)", VERBS[verb].epilog or "")
    assert examples
    for example in examples:
        assert shlex.split(example)[0] == verb
        parse(shlex.split(example))


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(repository, page):
    targets = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", (repository / page).read_text(encoding="utf-8"))
    assert [target for target in targets if not (repository / target).exists()] == []


@pytest.mark.slow
def test_a_scenario_of_ones_own_is_rendered_answered_and_judged(readme, mine):
    own = [words for words in commands(readme) if any("mine" in word for word in words)]
    assert [words[0] for words in own] == ["render", "estimate", "judge"]
    for words in own:
        hardlight(*words, *(("--frames", "0:15:5", "--quality", "fast") if words[0] == "render" else ()), cwd=mine)
    answers = pd.read_csv(mine / "answers/mine/predictions.csv")
    assert list(answers["outcome"]) == ["ok"] * 3
    scores = pd.read_parquet(mine / "scores/mine/scores.parquet")
    assert scores["geodesic_deg"].max() < 1.0


def test_the_truth_layers_are_those_of_the_conventions(repository, mine):
    hardlight("render", "./mine.toml", "--out", "one", "--frames", "0:1", "--quality", "draft", cwd=mine)
    text = (repository / "CONVENTIONS.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`.+?) \| (float32|uint32) \|", text, re.MULTILINE)
    expected = {name: kind for names, kind in rows for name in expanded(names)}
    layers = Dataset.open(mine / "one").layers(0, "nav")
    assert {name: layer.dtype.name for name, layer in layers.items()} == expected


def expanded(cell: str) -> list[str]:
    """`normal.x`, `.y` → normal.x, normal.y."""
    names: list[str] = re.findall(r"`([\w.]+)`", cell)
    return [name if not name.startswith(".") else names[0].partition(".")[0] + name for name in names]


def test_the_values_that_the_readme_replaces_can_be_replaced(readme, mine):
    sets = re.findall(r"--set (\S+?)[\s`]", readme.read_text(encoding="utf-8"))
    assert len(sets) >= 2
    before, after = (load_scenario(str(mine / "mine.toml"), given) for given in ([], sets))
    assert before.model_dump() != after.model_dump()
    assert after.cameras["nav"].detector.bits == 12
    assert after.target.parts[0].material.type == "paint"


def python(code: str, cwd: Path) -> str:
    done = subprocess.run([sys.executable, "-c", code], cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def program(readme: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Where the README's program ran, and what it printed."""
    (block,) = blocks(readme, "python")
    assert counted(block) <= 15
    folder = tmp_path_factory.mktemp("program")
    return folder, python(block, folder)


def test_the_program_in_the_readme_runs(program):
    _, printed = program
    errors = [float(text) for text in re.findall(r"^\d+ ([\d.]+) rad off$", printed, re.MULTILINE)]
    assert len(errors) == len(printed.splitlines()) == 4
    assert max(errors) < 0.02
