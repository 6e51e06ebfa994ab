"""The shape of a progress report: frames done, frames in all."""

from collections.abc import Callable

Progress = Callable[[int, int], None]
