"""The ranging of Song et al. 2017, section 4: true ranges with noise, more of it at edges, and a dead zone at large angles."""

import numpy as np

from renderer.beams import Echoes
from renderer.reports import Reports
from scenes.arrays import Bools
from scenes.beam_fate import BeamFate
from scenes.provenance import stream
from scenes.ranging_model import PaperRanging


def paper_reports(model: PaperRanging, echoes: Echoes, gate_m: tuple[float, float], seed: int, frame: int, name: str) -> Reports:
    """What is reported of each beam, from the ray along its axis; the other sub-rays only tell where there is an edge.

    Each kind of noise has a stream of its own, in which a beam has its own place whatever the others meet. Intensity is
    π · BSDF · cosine: 1 for a white matt surface face on.
    """
    hit = echoes.cosine > 0
    reports = Reports.empty(1, len(hit))
    beams = np.flatnonzero(hit[:, 0])
    range_m = echoes.range_m[beams, 0].astype(np.float64)
    fate = np.where((range_m < gate_m[0]) | (range_m > gate_m[1]), BeamFate.GATED, BeamFate.RETURN)
    fate = np.where((fate == BeamFate.RETURN) & _cut_off(model, echoes, seed, frame, name)[beams], BeamFate.CUT_OFF, fate)
    noise = stream(seed, frame, f"{name}.range").standard_normal(len(hit))[beams] * model.sigma_m
    edge = stream(seed, frame, f"{name}.edge").standard_normal(len(hit))[beams] * model.edge_sigma_m
    measured = range_m + noise + np.where(straddles(echoes.rows(beams), model.edge_step_m), edge, 0.0)
    seen = fate == BeamFate.RETURN
    reports.fate[0, beams] = fate
    reports.source[0, beams] = 0
    reports.measured_m[0, beams[seen]] = measured[seen]
    reports.intensity[0, beams[seen]] = np.pi * echoes.retro[beams[seen], 0]
    reports.energy_fraction[0, beams] = hit[beams].mean(axis=1)
    return reports


def straddles(echoes: Echoes, step_m: float) -> Bools:
    """Beams (n,) whose spot lies across an edge: some of it passes by, or the surface is bent by more than ``step_m`` within it.

    Opposite sub-rays of a ring meet a plane, however tilted, at ranges whose mean is that of the axis.
    """
    count = (echoes.cosine > 0).sum(axis=1)
    whole, range_m = count == echoes.cosine.shape[1], echoes.range_m.astype(np.float64)
    bent = np.zeros(len(count), np.bool_)
    for first, last in ((1, 7), (7, 19)):
        half = (first + last) // 2
        apart = (range_m[:, first:half] + range_m[:, half:last]) / 2 - range_m[:, :1]
        bent |= (np.abs(apart) > step_m).any(axis=1)
    return np.asarray((count > 0) & (~whole | bent))


def _cut_off(model: PaperRanging, echoes: Echoes, seed: int, frame: int, name: str) -> Bools:
    """Beams (n,) that the dead zone swallows: kept with the logistic probability of their incidence."""
    incidence = np.degrees(np.arccos(np.clip(echoes.cosine[:, 0].astype(np.float64), -1, 1)))
    odds = np.exp(np.clip((incidence - model.cutoff_deg) / model.cutoff_width_deg, -700, 700))
    drawn = stream(seed, frame, f"{name}.cut-off").random(len(incidence))
    return np.asarray(drawn * (1 + odds) > 1)
