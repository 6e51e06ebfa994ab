"""Quality presets: how many samples, and whether the indirect layer is filtered. Direct light is never filtered."""

import math
from dataclasses import dataclass

from renderer.integrator import MAX_SCATTERINGS


@dataclass(frozen=True, slots=True)
class Preset:
    """Samples per pixel (square numbers, for the stratified grid), the number of scatterings followed, and the filter.

    ``stratified`` spreads a pixel's samples over a grid: silhouettes then converge like n^-0.85 instead of n^-0.5.
    """

    direct_samples: int
    indirect_samples: int
    max_scatterings: int = MAX_SCATTERINGS
    denoise_indirect: bool = True
    stratified: bool = True

    def __post_init__(self) -> None:
        """Raises ``ValueError`` where a grid has gaps or reaches out of its pixel."""
        for layer, samples in (("direct", self.direct_samples), ("indirect", self.indirect_samples)):
            if self.stratified and math.isqrt(samples) ** 2 != samples:
                raise ValueError(f"{samples} {layer} samples fill no square grid")


PRESETS = {
    "reference": Preset(256, 256, denoise_indirect=False),
    "standard": Preset(64, 16),
    "fast": Preset(16, 4),
    "draft": Preset(16, 0, denoise_indirect=False),
}
