"""Names that anybody may have chosen as parts of links: letters, digits and hyphens alone, each once."""

import re
import unicodedata
from collections.abc import Sequence

_LONGEST = 60


def slugs(names: Sequence[str], prefix: str) -> dict[str, str]:
    """Name → ``prefix`` and a slug that no other of the ``names`` has. Names that are slugs already keep theirs."""
    found: dict[str, str] = {name: f"{prefix}{name}" for name in names if _slug(name) == name}
    taken = set(found.values())
    for name in names:
        if name in found:
            continue
        wanted = f"{prefix}{_slug(name) or 'unnamed'}"
        numbered = (f"{wanted}-{number}" for number in range(2, len(names) + 2))
        found[name] = next(one for one in (wanted, *numbered) if one not in taken)
        taken.add(found[name])
    return found


def _slug(name: str) -> str:
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[:_LONGEST].strip("-")
