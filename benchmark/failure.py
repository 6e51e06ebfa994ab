"""Any exception as one sentence and an exit status: what a user can mend, what the system refused, what is our mistake."""

from collections.abc import Sequence
from typing import Any

from scenes.errors import FAULT_FOUND, WRONG_USAGE, HardlightError


def describe(error: Exception, verb: str, arguments: Sequence[str] = ()) -> tuple[str, int]:
    """The sentence (empty where it was shown already) and the exit status for ``error``, raised by ``verb``."""
    if isinstance(error, HardlightError):
        return str(error), error.exit_status
    if hasattr(error, "format_message"):  # the command line's own complaints, whose base class typer keeps private
        return _usage(error, verb, arguments)
    if isinstance(error, OSError):
        return f"{error.filename or 'the system'}: {error.strerror or error}", FAULT_FOUND
    if isinstance(error, MemoryError):
        return "out of memory; use fewer --workers or a smaller picture", FAULT_FOUND
    name = f"{type(error).__name__}: {error}".strip(": ")
    return f"internal error ({name}); please report it with the output of the same command with --debug", FAULT_FOUND


def is_interruption(error: BaseException) -> bool:
    """Whether Ctrl-C is at the bottom of ``error``: Dr.Jit wraps what is raised while it records a kernel."""
    cause: BaseException | None = error
    while cause is not None and not isinstance(cause, KeyboardInterrupt):
        cause = cause.__cause__ or cause.__context__
    return cause is not None


def _usage(error: Any, verb: str, arguments: Sequence[str]) -> tuple[str, int]:
    if type(error).__name__ == "NoArgsIsHelpError":
        error.show()
        return "", WRONG_USAGE
    text = " ".join(str(error.format_message()).split()).rstrip(".")
    given = _given(error, arguments)
    if given is not None and text.startswith("Invalid value for") and ": " in text:
        head, _, reason = text.partition(": ")
        text = f"{head}: got {given!r}, {reason[:1].lower()}{reason[1:]}"
    return f"{text}; see hardlight {f'{verb} ' if _is_verb(error) else ''}--help", WRONG_USAGE


def _given(error: Any, arguments: Sequence[str]) -> str | None:
    """What was typed for the option that is complained about; the complaint itself does not say it."""
    for option in getattr(getattr(error, "param", None), "opts", ()):
        for argument, following in zip(arguments, [*arguments[1:], ""], strict=True):
            if argument == option:
                return following
            if argument.startswith(f"{option}="):
                return argument.partition("=")[2]
    return None


def _is_verb(error: Any) -> bool:
    context = getattr(error, "ctx", None)
    return context is not None and context.parent is not None
