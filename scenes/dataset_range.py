"""Which frames: the text ``a:b[:step]`` or ``n`` against the number of frames a scenario has."""

from scenes.errors import UsageError


def parse_frames(text: str, total: int) -> range:
    """The frames that ``text`` selects out of ``range(total)``, with Python's slice meaning (``b`` itself is not included).

    ``"7"`` is one frame, ``"0:40"`` the first forty, ``":"`` all, ``"::20"`` every twentieth. Unlike a slice, nothing is cut
    off silently: raises ``UsageError`` where the range is not a number, empty, backward or outside the scenario.
    """
    parts = text.strip().split(":")
    if len(parts) > 3:
        raise UsageError(f"--frames {text!r} has {len(parts)} parts; write n, a:b or a:b:step")
    numbers = [_number(part, text) for part in parts]
    if len(parts) == 1:
        return _inside(range(numbers[0] or 0, (numbers[0] or 0) + 1), text, total)
    start, stop, step = (*numbers, None)[:3]
    if step is not None and step < 1:
        raise UsageError(f"--frames {text!r} has step {step}; a step is at least 1")
    return _inside(range(start or 0, total if stop is None else stop, step or 1), text, total)


def _number(part: str, text: str) -> int | None:
    if not part.strip():
        return None
    try:
        return int(part)
    except ValueError:
        raise UsageError(f"--frames {text!r}: {part!r} is not a whole number; write n, a:b or a:b:step") from None


def _inside(frames: range, text: str, total: int) -> range:
    if not text.strip():
        raise UsageError("--frames is empty; write n, a:b or a:b:step")
    if min(frames.start, frames.stop) < 0 or frames.stop > total or frames.start >= total:
        raise UsageError(f"--frames {text!r} lies outside the scenario, which has frames 0 to {total - 1} (0:{total})")
    if not frames:
        raise UsageError(f"--frames {text!r} selects no frame: the start {frames.start} is not below the stop {frames.stop}")
    return frames
