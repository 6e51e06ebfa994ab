"""The command that renders a frame again, as anybody can type it: a library scenario, what differs from it, no machine's paths."""

import json
import shlex
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

from scenes.config import list_library
from scenes.dataset_manifest import Manifest
from scenes.errors import HardlightError
from scenes.provenance import canonical_json
from scenes.scenario import load_scenario

_MOST_DIFFERENCES = 16
_OWN = ("seed", "quality")  # options of their own


class _InexpressibleError(ValueError):
    """A difference that no ``--set`` makes."""


def command(manifest: Manifest, frame: int, name: str) -> str:
    """``hardlight render`` of one frame. ``name`` stands for a scenario that the library does not make."""
    known = _from_library(canonical_json(manifest.scenario))
    words = ["hardlight", "render", *(known or [f"{name}.toml"]), "--seed", str(manifest.seed), "--frames", f"{frame}:{frame + 1}"]
    quality = manifest.quality.get("name") if isinstance(manifest.quality, dict) else manifest.quality
    words += ["--quality", quality] if isinstance(quality, str) else []
    return shlex.join([*words, "--out", f"{name}-{frame}"])


@lru_cache(maxsize=256)
def _from_library(scenario: str) -> list[str]:
    """A library scenario and its overrides that give the manifest's, which is JSON; empty where there are none."""
    wanted = {key: value for key, value in json.loads(scenario).items() if key not in _OWN}
    for name in (name for name, says in list_library("scenario").items() if says == wanted.get("description")):
        plain = _plain(name, ())
        try:
            found = [f"{path}={value}" for path, value in _differences(plain, wanted, "")]
        except _InexpressibleError:
            continue
        if len(found) <= _MOST_DIFFERENCES and (not found or _gives(name, found, wanted)):
            return [name, *(word for one in found for word in ("--set", one))]
    return []


def _plain(name: str, overrides: tuple[str, ...]) -> dict[str, Any]:
    """A library scenario, resolved, without what has options of its own."""
    plain = load_scenario(name, overrides).model_dump(mode="json")
    return {key: value for key, value in plain.items() if key not in _OWN}


def _gives(name: str, overrides: list[str], wanted: Mapping[str, Any]) -> bool:
    """Whether the command says what it should: an override may be laid over what it was not meant for."""
    try:
        return _plain(name, tuple(overrides)) == wanted
    except HardlightError:
        return False


def _differences(here: Mapping[str, Any], there: Mapping[str, Any], path: str) -> Iterator[tuple[str, str]]:
    """Key paths and TOML values that make ``there`` of ``here``."""
    if here.keys() - there.keys():
        raise _InexpressibleError(path)
    for key, value in there.items():
        mine = here.get(key)
        if value == mine:
            continue
        if isinstance(value, dict) and isinstance(mine, dict):
            yield from _differences(mine, value, f"{path}{key}.")
        else:
            yield f"{path}{key}", _toml(value)


def _toml(value: Any) -> str:
    """A number, a text or a list of these, which JSON writes as TOML does."""
    parts = value if isinstance(value, list) else [value]
    if not all(isinstance(one, int | float | str | bool) for one in parts):
        raise _InexpressibleError(value)
    return json.dumps(value, ensure_ascii=False)
