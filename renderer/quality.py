"""Quality presets: how many samples, and whether the indirect layer is filtered. Direct light is never filtered."""

from dataclasses import dataclass

from renderer.integrator import MAX_SCATTERINGS
from renderer.sampling import MOST_SAMPLES


@dataclass(frozen=True, slots=True)
class Preset:
    """Samples per pixel (powers of two, so that they fill a net), the number of scatterings followed, and the filter.

    ``stratified`` spreads a pixel's samples over nets (``renderer.sampling``): places and lights then converge faster than
    n^-0.5.
    """

    direct_samples: int
    indirect_samples: int
    max_scatterings: int = MAX_SCATTERINGS
    denoise_indirect: bool = True
    stratified: bool = True

    def __post_init__(self) -> None:
        """Raises ``ValueError`` where a net has gaps or is larger than there are points."""
        for layer, samples in (("direct", self.direct_samples), ("indirect", self.indirect_samples)):
            if self.stratified and (samples & (samples - 1) or samples > MOST_SAMPLES):
                raise ValueError(f"{samples} {layer} samples fill no net: powers of two up to {MOST_SAMPLES} do")


PRESETS = {
    "reference": Preset(256, 256, denoise_indirect=False),
    "standard": Preset(64, 16),
    "fast": Preset(16, 4),
    "draft": Preset(16, 0, denoise_indirect=False),
}
