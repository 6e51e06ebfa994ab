"""What the light did in each pixel of the target, as bits."""

from enum import IntFlag
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Light(IntFlag):
    """Bits of the ``mask`` layer. LIT, ATTACHED_SHADOW and CAST_SHADOW exclude each other and cover the target."""

    LIT = 1
    ATTACHED_SHADOW = 2  # turned away from the light
    CAST_SHADOW = 4  # turned to the light, something stands in between
    SPECULAR = 8  # the mirror-like lobe outweighs all other light
    SATURATED = 16  # the pixel's digital number or its well is at its end


def light_mask(layers: dict[str, NDArray[Any]], part_id: NDArray[np.uint32], saturated: NDArray[np.bool_]) -> NDArray[np.uint32]:
    """Bits (h, w) for the pixels whose centre lies on the target, 0 elsewhere.

    Shadows go by the larger part of what the pixel sees of the target: ``facing`` and ``unshadowed`` of ``coverage``.
    """
    covered = np.maximum(layers["coverage"], np.float32(1e-6))
    facing = layers["facing"] >= 0.5 * covered
    seen = layers["unshadowed"] >= 0.5 * np.maximum(layers["facing"], np.float32(1e-6))
    rest = layers["direct_diffuse"] + layers["indirect"]
    specular = layers["direct_specular"] > rest
    bits = np.where(facing, np.where(seen, Light.LIT, Light.CAST_SHADOW), Light.ATTACHED_SHADOW).astype(np.uint32)
    bits |= np.where(specular, np.uint32(Light.SPECULAR), np.uint32(0))
    bits |= np.where(saturated, np.uint32(Light.SATURATED), np.uint32(0))
    return np.where(part_id > 0, bits, 0).astype(np.uint32)


def fractions(mask: NDArray[np.uint32]) -> dict[str, float]:
    """Share of the target's visible pixels in each state; NaN where no pixel of it is visible."""
    states = mask[mask > 0]
    names = {
        "lit_fraction": Light.LIT,
        "shadow_fraction": Light.ATTACHED_SHADOW | Light.CAST_SHADOW,
        "specular_fraction": Light.SPECULAR,
        "saturated_fraction": Light.SATURATED,
    }
    return {name: float(np.mean((states & np.uint32(bits)) > 0)) if states.size else float("nan") for name, bits in names.items()}
