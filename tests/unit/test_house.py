"""House rules that a machine can check: pins without hosts, no paths of any machine, who may import what, sizes, quick help."""

import ast
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PACKAGES = ("scenes", "renderer", "estimators", "benchmark")
LONGEST_FUNCTION = 40  # lines without the docstring
LONGEST_FILE = 300
HELP_CPU_S = 0.5
HEAVY = ("mitsuba", "drjit", "numpy", "scipy", "pandas", "cv2", "matplotlib", "trimesh", "pyarrow")
Function = ast.FunctionDef | ast.AsyncFunctionDef


@pytest.fixture(scope="module")
def tracked(repository: Path) -> list[Path]:
    """Every file of the repository; without git, or in a copy without history, every file that is no tool's cache."""
    git = shutil.which("git")
    listing = (
        subprocess.run([git, "-C", repository, "ls-files", "-z"], capture_output=True, text=True, check=False) if git else None
    )
    if listing is not None and listing.returncode == 0:
        return [path for name in listing.stdout.split("\0") if (path := repository / name).is_file()]
    made = re.compile(r"\.venv.*|\.git|\..*cache|\.hypothesis|__pycache__|.*\.egg-info|out")
    files = (path for path in repository.rglob("*") if path.is_file())
    return [path for path in files if not any(made.fullmatch(part) for part in path.relative_to(repository).parts)]


@pytest.fixture(scope="module")
def modules(repository: Path) -> dict[Path, ast.Module]:
    """Every module of the four packages, parsed."""
    sources = (path for package in PACKAGES for path in (repository / package).rglob("*.py"))
    return {path.relative_to(repository): ast.parse(path.read_text(encoding="utf-8")) for path in sources}


def text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return ""


def pins(repository: Path) -> list[str]:
    lines = (repository / "constraints.txt").read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def test_constraints_are_pins_and_nothing_else(repository):
    faults = [line for line in pins(repository) if not re.fullmatch(r"[a-z0-9][a-z0-9._-]*==[0-9][0-9a-z.+!]*", line)]
    assert faults == []


def test_every_dependency_is_pinned_within_its_range(repository):
    project = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    pinned = dict(line.split("==") for line in pins(repository))
    wanted = [Requirement(text) for text in project["dependencies"] + project["optional-dependencies"]["dev"]]
    faults = [str(one) for one in wanted if pinned.get(canonicalize_name(one.name), "none") not in one.specifier]
    assert faults == []


@pytest.mark.parametrize("name", ["constraints.txt", "pyproject.toml", "run", ".ci/run"])
def test_what_installs_names_no_host(repository, name):
    found = re.findall(r"\w+://\S*|\S*index.url\S*|\S*find.links\S*|\S*trusted-host\S*|\S+@\S+\.\w+", text_of(repository / name))
    assert [one for one in found if "$@" not in one] == []


def test_no_file_holds_a_path_of_a_machine(repository, tracked):
    homes = "|".join(("work", "root", "home", "Users", "mnt", "srv", "workspace"))
    private = re.compile(rf"""(?:^|[\s"'`=(:])((?:/(?:{homes})/|\.\./shared/|file:/|[A-Z]:\\)[\w.-]+)""", re.MULTILINE)
    faults = {str(path.relative_to(repository)): private.findall(text_of(path)) for path in tracked}
    assert {name: found for name, found in faults.items() if found} == {}


def imported(tree: ast.Module) -> Iterator[str]:
    """Top-level names of everything that a module imports, at its head or within functions."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module.partition(".")[0]


def test_only_the_renderer_imports_mitsuba(modules):
    others = {path: set(imported(tree)) for path, tree in modules.items() if path.parts[0] != "renderer"}
    assert [str(path) for path, names in others.items() if names & {"mitsuba", "drjit"}] == []


def test_an_estimator_author_needs_no_mitsuba(modules):
    """Every module of scenes and estimators is imported where Mitsuba cannot be."""
    names = [".".join(path.with_suffix("").parts) for path in modules if path.parts[0] in ("scenes", "estimators")]
    script = (
        "import importlib, sys\n"
        "sys.modules.update(mitsuba=None, drjit=None)\n"
        "for name in sys.argv[1:]: importlib.import_module(name)\n"
    )
    names = [name.removesuffix(".__init__") for name in names]
    done = subprocess.run([sys.executable, "-c", script, *names], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def lines_without_docstring(function: Function) -> int:
    length = (function.end_lineno or 0) - function.lineno + 1
    first = function.body[0]
    if ast.get_docstring(function, clean=False) is not None:
        length -= (first.end_lineno or 0) - first.lineno + 1
    return length


def test_functions_are_short(modules):
    functions = [(path, node) for path, tree in modules.items() for node in ast.walk(tree) if isinstance(node, Function)]
    lengths = {f"{path}:{node.lineno} {node.name}": lines_without_docstring(node) for path, node in functions}
    assert {where: length for where, length in lengths.items() if length > LONGEST_FUNCTION} == {}


def test_files_are_short(repository, modules):
    lengths = {str(path): len((repository / path).read_text(encoding="utf-8").splitlines()) for path in modules}
    assert {path: length for path, length in lengths.items() if length > LONGEST_FILE} == {}


def test_public_functions_and_classes_say_what_they_are(modules):
    faults = []
    for path, tree in modules.items():
        public = [node for node in tree.body if isinstance(node, Function | ast.ClassDef) and not node.name.startswith("_")]
        faults += [f"{path}:{node.lineno} {node.name}" for node in public if not ast.get_docstring(node)]
        faults += [] if ast.get_docstring(tree) else [f"{path}: the module"]
    assert faults == []


def help_cpu_s() -> float:
    """CPU seconds of one ``hardlight --help``, user and system."""
    command = [sys.executable, "-c", "from benchmark.cli import main; main(['--help'])"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    return usage.ru_utime + usage.ru_stime


def test_help_answers_at_once():
    fastest = min(help_cpu_s() for _ in range(5))
    assert fastest <= HELP_CPU_S


def test_help_loads_nothing_heavy():
    script = (
        "import atexit, sys\n"
        "from benchmark.cli import main\n"
        f"atexit.register(lambda: print('HEAVY', [name for name in {HEAVY!r} if name in sys.modules]))\n"
        "main(['--help'])\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "HEAVY []"
