"""The command that made a folder of results, as somebody else would type it: no path of this machine."""

import shlex
from pathlib import Path

UNKNOWN = "hardlight report DIR"
"""What made the page, where nobody wrote down what made the results."""


def command(verb: str, *words: str | Path) -> str:
    """``hardlight VERB WORD ...``, quoted for a shell; of a path outside the working directory the last part alone."""
    return shlex.join(["hardlight", verb, *(_short(word) if isinstance(word, Path) else word for word in words)])


def named(name: str) -> str | Path:
    """What a person typed that is a library's name, or a path: a path where it has a folder or an ending."""
    return Path(name) if Path(name).name != name or Path(name).suffix else name


def _short(path: Path) -> str:
    there, here = path.absolute(), Path.cwd()
    return there.relative_to(here).as_posix() if there.is_relative_to(here) and there != here else there.name or "."
