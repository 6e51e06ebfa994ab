"""``hardlight list``: what the library holds and which estimators are registered, a line each."""

from scenes.errors import UsageError, unknown

KINDS = (
    *("scenarios", "estimators", "suites", "studies", "papers"),
    *("targets", "cameras", "rigs", "lidars", "lights", "displays", "materials"),
)


def listing(kind: str) -> list[tuple[str, str]]:
    """(name, one-line description) of everything of ``kind``; kinds are those of ``KINDS``."""
    if kind not in KINDS:
        raise UsageError(unknown("kind", kind, KINDS))
    if kind == "estimators":
        return _estimators()
    if kind == "papers":
        return _papers()
    from scenes.config import list_library

    return sorted(dict(list_library(kind)).items())


def _estimators() -> list[tuple[str, str]]:
    from benchmark import methods
    from estimators import registry

    return [(name, methods.description(name)) for name in registry.names()]


def _papers() -> list[tuple[str, str]]:
    """By their titles: what describes a paper is a paragraph of its own page."""
    from benchmark.paper_spec import Paper
    from scenes.config import list_library, load

    return [(name, load("paper", name, Paper).title) for name in sorted(list_library("paper"))]
