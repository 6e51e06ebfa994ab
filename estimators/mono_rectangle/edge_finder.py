"""One edge in one picture: predicted line → coarse search → fine fit → gates → the candidates that are left."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.mono_rectangle.closed_form import depth_ratios
from estimators.mono_rectangle.edge_refit import EdgeFit, EdgeRefit
from estimators.mono_rectangle.edge_search import search_lines
from estimators.mono_rectangle.parameters import TrackedParameters
from estimators.mono_rectangle.quadrilateral import LONG_EDGES, edge_ends, edge_normals, normalised_from_ideal
from estimators.mono_rectangle.stations import image_fraction, stations_along
from estimators.mono_rectangle.vertex_track import VertexTrack, line_innovation
from estimators.mono_rectangle.visibility import GreyScale, why_invisible
from scenes.arrays import Floats
from scenes.intrinsics import Intrinsics
from scenes.recording import Rectangle

_SAME_LINE_PX = 0.5
_MOST_TRIM_PX = 3.0  # by which an unknown corner shortens an edge at most
_SUPPORT_COST = 8.0  # what a wholly unsupported edge would cost, in squared sigmas of the prediction


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A visible line that may be the edge; ``cost``: squared sigmas from the prediction and a price on missing support."""

    fit: EdgeFit
    noise: Floats
    cost: float


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """What was seen of one edge: candidates, cheapest first; ``reason`` says why there is none."""

    candidates: tuple[Candidate, ...]
    reason: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class EdgeFinder:
    """Finds the edges of one rectangle in one sensor's pictures."""

    intrinsics: Intrinsics
    grey: GreyScale
    rectangle: Rectangle
    parameters: TrackedParameters

    def find(self, pixels: NDArray[np.generic], track: VertexTrack, edge: int) -> Sighting:
        """The candidates for an edge near its predicted place."""
        p, ends = self.parameters, edge_ends(track.vertices_px)[edge]
        refit, window = self._looking(track, edge)
        normal = edge_normals(ends, refit.centre_px)
        stations = stations_along(ends, normal, self.intrinsics, refit.trim, refit.gap)
        half_step_dn = 2 * p.min_step * (self.grey.white_dn - self.grey.black_dn)
        polarities = (1,) if self.rectangle.free_standing else (1, -1)
        found: list[Candidate] = []
        reason = ""
        for shift, polarity in search_lines(pixels, stations, window, half_step_dn, polarities, p.candidates):
            fit = refit.fit(pixels, ends + shift[:, None] * normal, polarity)
            verdict, candidate = self._judge(fit, track, edge, window)
            if candidate is not None and not any(_same(candidate, other) for other in found):
                found.append(candidate)
            reason = reason or verdict
        found.sort(key=lambda candidate: candidate.cost)
        return Sighting(tuple(found), "" if found else reason or "no straight step of brightness near it")

    def _looking(self, track: VertexTrack, edge: int) -> tuple[EdgeRefit, float]:
        """How to look at an edge, and how far from its predicted place, px: the less certain that is, the farther."""
        p, vertices = self.parameters, track.vertices_px
        centre = vertices.mean(axis=0)
        covariance = track.line_covariance(edge, edge_normals(edge_ends(vertices)[edge], centre))
        spread = float(np.sqrt(np.diag(covariance).max()))
        trim = (p.trim_fraction, p.trim_px + min(spread, _MOST_TRIM_PX))
        levels = (p.level_from_px, p.level_to_px)
        refit = EdgeRefit(self.intrinsics, centre, p.kernel_sigma_px, trim, self._gap(vertices, edge), levels)
        return refit, min(p.min_window_px + p.window_sigmas * spread, p.max_window_px)

    def _judge(self, fit: EdgeFit | None, track: VertexTrack, edge: int, window: float) -> tuple[str, Candidate | None]:
        if fit is None:
            return "the line fit ran away", None
        if verdict := why_invisible(fit, self.grey, self.rectangle.free_standing, self.parameters):
            return verdict, None
        noise = fit.covariance + self.parameters.vertex_sigma_px**2 * np.eye(2)
        gap, squared = line_innovation(track, edge, fit.ends_px, fit.normal, noise)
        if np.abs(gap).max() > window + 1 or squared > self.parameters.edge_gate_sigmas**2:
            return f"the nearest line is {np.abs(gap).max():.1f} px from where it should be", None
        return "", Candidate(fit, noise, squared + _SUPPORT_COST * (1 - fit.support))

    def _gap(self, vertices_px: Floats, edge: int) -> tuple[float, float] | None:
        """Image fractions between which a long edge does not exist: the declared fractions, seen in perspective."""
        if self.rectangle.gap is None or edge not in LONG_EDGES:
            return None
        ratios = depth_ratios(normalised_from_ideal(vertices_px, self.intrinsics))
        ratio = float(ratios.a if edge == 0 else ratios.c / ratios.b)
        ratio = float(np.clip(ratio, 0.5, 2.0)) if np.isfinite(ratio) else 1.0
        margin = self.parameters.gap_margin
        low, high = self.rectangle.gap[0] - margin, self.rectangle.gap[1] + margin
        return image_fraction(max(low, 0.0), ratio), image_fraction(min(high, 1.0), ratio)


def _same(one: Candidate, other: Candidate) -> bool:
    return float(np.abs((one.fit.ends_px - other.fit.ends_px) @ one.fit.normal).max()) < _SAME_LINE_PX
