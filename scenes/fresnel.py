"""How much light a smooth surface reflects at normal incidence (Born & Wolf, Principles of Optics, sections 1.5, 14.2)."""

import numpy as np

from scenes.arrays import Floats


def normal_reflectance(n: Floats, k: Floats, outside: float = 1.0) -> Floats:
    """Reflectance where a medium of index ``outside`` meets one of index n + ik: |(n + ik − m) / (n + ik + m)|²."""
    return np.asarray(((n - outside) ** 2 + k**2) / ((n + outside) ** 2 + k**2))


def film_reflectance(front: Floats, transmittance: Floats, back: Floats) -> Floats:
    """Reflectance of a film thick against the coherence length: F + (1 − F)² τ² R / (1 − F τ² R).

    ``front`` F: of its face; ``transmittance`` τ: of its inside, one way; ``back`` R: of what it lies on, seen from inside.
    """
    round_trip = transmittance**2 * back
    return np.asarray(front + (1 - front) ** 2 * round_trip / (1 - front * round_trip))


def extinction_for(reflectance: float, n: float) -> float:
    """The k with which a conductor of index n + ik has this normal reflectance, or 0 where n alone reflects as much."""
    below_one = min(reflectance, 1 - 1e-9)
    return float(np.sqrt(max(below_one * (n + 1) ** 2 - (n - 1) ** 2, 0.0) / (1 - below_one)))
