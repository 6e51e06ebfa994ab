"""CPU seconds of the stages of one step, as extras."""

import time
from dataclasses import dataclass, field


@dataclass(slots=True)
class Stopwatch:
    """``extras``: ``cpu_<stage>_s`` of every stage so far; a stage that comes twice is added up."""

    extras: dict[str, float] = field(default_factory=dict)
    _since: float = field(default_factory=time.process_time)

    def ends(self, stage: str) -> None:
        """Everything since the last end belongs to ``stage``."""
        now = time.process_time()
        name = f"cpu_{stage}_s"
        self.extras[name] = self.extras.get(name, 0.0) + now - self._since
        self._since = now
