"""A rigid rectangle keeps its L/W: the ratio seen so far tells when an edge has been mistaken for a parallel neighbour.

The closed form gives the ratio with every frame; only its constancy is used, never its value.
"""

import numpy as np
from numpy.typing import ArrayLike

from estimators.mono_rectangle.quadrilateral import edge_ends
from estimators.mono_rectangle.solution import Solution
from scenes.arrays import Floats


class AspectMemory:
    """Weighted mean of log(L/W) over the accepted frames; a floor stands for what does not average out (strips along
    the edges: ``shift_sigma_px``)."""

    def __init__(self, shift_sigma_px: float, gate_sigmas: float) -> None:
        """An empty memory."""
        self._shift_sigma_px, self._gate = shift_sigma_px, gate_sigmas
        self.forget()

    def forget(self) -> None:
        """Back to the beginning."""
        self._mean, self._weight = 0.0, 0.0

    def squared_sigmas(self, log_aspect: ArrayLike, sigma: float) -> Floats:
        """Squared departure from the mean, (...,), in sigmas; 0 while nothing is known."""
        if self._weight == 0:
            return np.zeros_like(np.asarray(log_aspect, dtype=np.float64))
        return np.asarray((np.asarray(log_aspect) - self._mean) ** 2 / (sigma**2 + 1 / self._weight))

    def why_not(self, solution: Solution) -> str:
        """A sentence if the solution's L/W contradicts the past; else "", and it is learned."""
        ends = edge_ends(solution.vertices_px)
        shortest_px = float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=-1).min())
        sigma = float(np.hypot(solution.log_aspect_sigma, self._shift_sigma_px / shortest_px))
        if self.squared_sigmas(solution.log_aspect, sigma) > self._gate**2:
            now, before = np.exp(solution.log_aspect), np.exp(self._mean)
            return f"its sides are as {now:.2f} to 1, before they were as {before:.2f} to 1: an edge is another's"
        self._weight += 1 / sigma**2
        self._mean += (solution.log_aspect - self._mean) / sigma**2 / self._weight
        return ""
