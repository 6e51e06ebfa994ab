"""Ellipses of a picture by arc-support line segments: the five steps of Shu et al. 2020, section 2.3.1 (after Lu et al. 2020)."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimators.stereo_ring.arc_groups import arc_groups
from estimators.stereo_ring.arcs import arc_support, edge_pieces
from estimators.stereo_ring.clusters import distinct
from estimators.stereo_ring.conics import Ellipse, ellipse_from_parameters
from estimators.stereo_ring.coverage import Covered, promising, refitted, verified
from estimators.stereo_ring.detector_parameters import DetectorParameters
from estimators.stereo_ring.ellipse_fits import ellipse_fits
from estimators.stereo_ring.growth import grown
from estimators.stereo_ring.lit_window import lit_window
from estimators.stereo_ring.segments import in_camera_pixels, line_segments, reduced
from scenes.arrays import Floats

_ROOM = 2  # so many times the candidates that are asked for are refitted


@dataclass(frozen=True, slots=True)
class Candidate:
    """An ellipse in the camera's pixels, the share of it that is an edge (``coverage``), the rms distance of that edge
    (``rms_px``), and how bright its inside is: ``bright_inside`` +1 all round, −1 nowhere, between where that changes."""

    ellipse: Ellipse
    coverage: float
    rms_px: float
    bright_inside: float


def detect_ellipses(picture: NDArray[np.uint8], parameters: DetectorParameters) -> tuple[Candidate, ...]:
    """The ellipses of an eight-bit picture (height, width), the best covered first; none in a picture without edges."""
    rows, columns = lit_window(picture, parameters.window_contrast_dn)
    found = _found(np.ascontiguousarray(picture[rows, columns]), parameters)
    return tuple(replace(one, ellipse=_shifted(one.ellipse, columns.start, rows.start)) for one in found)


def _found(picture: NDArray[np.uint8], parameters: DetectorParameters) -> tuple[Candidate, ...]:
    """The five steps."""
    plain = reduced(picture, parameters)  # a root moves edges to their dark side: it may find, not measure
    small = reduced(picture, parameters, parameters.root_dn) if parameters.root_dn else plain
    pieces = edge_pieces(small, line_segments(small, parameters))
    arcs = arc_support(pieces, parameters)
    groups = arc_groups(arcs, parameters, small.scale)
    fits = promising(small, ellipse_fits(arcs, groups, parameters, small.scale), parameters)
    found = verified(small, grown(fits, pieces, parameters, small.scale), parameters)
    nearer_than = parameters.duplicate_px * small.scale
    found = found.taken(distinct(found.ellipses, found.coverage, nearer_than, _ROOM * parameters.most_candidates))
    found = refitted(plain, small, found, parameters)
    found = found.taken(np.flatnonzero(_is_right(found, parameters, small.scale)))
    found = found.taken(distinct(found.ellipses, found.coverage - found.rms, nearer_than, parameters.most_candidates))
    return _candidates(found, small.scale)


def _shifted(ellipse: Ellipse, x_px: int, y_px: int) -> Ellipse:
    return replace(ellipse, x_px=ellipse.x_px + x_px, y_px=ellipse.y_px + y_px)


def _is_right(found: Covered, parameters: DetectorParameters, scale: float) -> np.ndarray:
    """Covered enough, explained, and still of a size that was asked for."""
    a, b = found.ellipses[:, 2], found.ellipses[:, 3]
    sized = (b >= parameters.min_semi_axis_px * scale) & (a <= parameters.max_semi_axis_px * scale)
    round_enough = b >= parameters.min_axis_ratio * a
    return np.asarray(sized & round_enough & (found.coverage >= parameters.min_coverage) & np.isfinite(found.rms))


def _candidates(found: Covered, scale: float) -> tuple[Candidate, ...]:
    ellipses: Floats = found.ellipses.copy()
    ellipses[:, :2] = in_camera_pixels(ellipses[:, :2], scale)
    ellipses[:, 2:4] /= scale
    rows = zip(ellipses, found.coverage, found.rms / scale, found.bright_inside, strict=True)
    return tuple(Candidate(ellipse_from_parameters(e), float(c), float(r), float(s)) for e, c, r, s in rows)
