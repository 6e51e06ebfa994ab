"""What a method's process finds around it: an environment, a module search path and a folder that lead to no data set."""

import json
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

SEARCH_PATH = "HARDLIGHT_WORKER_SEARCH_PATH"
PROGRAM = (
    f"import json, os, sys; sys.path[:] = json.loads(os.environ.pop('{SEARCH_PATH}')); "
    "from benchmark.isolation.worker import main; main()"
)
_OF_THE_SHELL = ("PWD", "OLDPWD", "_")


def environment(hidden: Sequence[Path], *, with_working_directory: bool) -> dict[str, str]:
    """This process's environment without the variables that name a folder in ``hidden`` or something in it.

    Hashing is the same in every run, so that a method which walks through a set of texts gives the same answers. What it prints
    is not held back, so that the last words of one that is killed are in its log. Modules are found where they are found here, and
    last ``with_working_directory``.
    """
    own = [str(Path(entry).absolute()) for entry in sys.path]  # an empty one is the working directory
    own += [str(Path.cwd())] if with_working_directory and str(Path.cwd()) not in own else []
    searched = [entry for entry in own if not _leads_to(entry, hidden)]
    own_way = {"PYTHONHASHSEED": "0", "PYTHONUNBUFFERED": "1"}
    return clean(os.environ, hidden) | own_way | {SEARCH_PATH: json.dumps(searched)}


def clean(variables: Mapping[str, str], hidden: Sequence[Path]) -> dict[str, str]:
    """The variables that do not lead to ``hidden``; what a shell keeps of where it is and what it ran is not among them."""
    return {
        name: value
        for name, value in variables.items()
        if name not in _OF_THE_SHELL and not any(_leads_to(piece, hidden) for piece in (value, *value.split(os.pathsep)))
    }


def _leads_to(text: str, hidden: Sequence[Path]) -> bool:
    """Whether ``text`` names a hidden folder or something in it, relative to here or anywhere in its middle."""
    if not text:
        return False
    folders = [folder.resolve() for folder in hidden]
    if any(str(folder) in text for folder in folders if folder != Path(folder.anchor)):
        return True
    try:
        there = Path(text).resolve()
    except (OSError, ValueError, RuntimeError):  # no path at all
        return False
    return any(there == folder or folder in there.parents for folder in folders) and there.exists()
