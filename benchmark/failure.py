"""Any exception as one sentence and an exit status: what a user can mend, what the system refused, what is our mistake."""

from typing import Any

from scenes.errors import FAULT_FOUND, WRONG_USAGE, HardlightError


def describe(error: Exception, verb: str) -> tuple[str, int]:
    """The sentence (empty where it was shown already) and the exit status for ``error``, raised by ``verb``."""
    if isinstance(error, HardlightError):
        return str(error), error.exit_status
    if hasattr(error, "format_message"):  # the command line's own complaints, whose base class typer keeps private
        return _usage(error, verb)
    if isinstance(error, OSError):
        return f"{error.filename or 'the system'}: {error.strerror or error}", FAULT_FOUND
    if isinstance(error, MemoryError):
        return "out of memory; use fewer --workers or a smaller picture", FAULT_FOUND
    name = f"{type(error).__name__}: {error}".strip(": ")
    return f"internal error ({name}); please report it with the output of the same command with --debug", FAULT_FOUND


def _usage(error: Any, verb: str) -> tuple[str, int]:
    if type(error).__name__ == "NoArgsIsHelpError":
        error.show()
        return "", WRONG_USAGE
    text = " ".join(str(error.format_message()).split()).rstrip(".")
    return f"{text}; see hardlight {f'{verb} ' if _is_verb(error) else ''}--help", WRONG_USAGE


def _is_verb(error: Any) -> bool:
    context = getattr(error, "ctx", None)
    return context is not None and context.parent is not None
