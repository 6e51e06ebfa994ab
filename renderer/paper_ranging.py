"""The ranging of Song et al. 2017, section 4: true ranges with noise, more of it at edges, and a dead zone at large angles."""

import numpy as np

from renderer.beams import Echoes
from renderer.pulses import pulses
from renderer.reports import Reports
from scenes.arrays import Bools, Floats
from scenes.beam_fate import BeamFate
from scenes.lidar import Lidar
from scenes.provenance import stream
from scenes.ranging_model import PaperRanging


def paper_reports(lidar: Lidar, model: PaperRanging, echoes: Echoes, seed: int, frame: int, name: str) -> Reports:
    """What is reported of each beam, from the ray along its axis; the other sub-rays only tell where there is an edge.

    Each kind of noise has a stream of its own, in which a beam has its own place whatever the others meet. Intensity is
    π · BSDF · cosine: 1 for a white matt surface face on.
    """
    count = len(echoes.cosine)
    reports = Reports.empty(1, count)
    beams = np.flatnonzero(echoes.cosine[:, 0] > 0)
    met = echoes.rows(beams)
    range_m, share = met.range_m[:, 0].astype(np.float64), _share_of_axis(met, model.edge_step_m, lidar.beam.spacing_rad)
    gated = (range_m < lidar.gate_m[0]) | (range_m > lidar.gate_m[1])
    removed = _cut_off(model, met, stream(seed, frame, f"{name}.cut-off").random(count)[beams])
    fate = np.select([gated, removed], [BeamFate.GATED, BeamFate.CUT_OFF], BeamFate.RETURN)
    noise, edge = (stream(seed, frame, f"{name}.{kind}").standard_normal(count)[beams] for kind in ("range", "edge"))
    measured_m = range_m + model.sigma_m * noise + np.where(share < 1, model.edge_sigma_m * edge, 0.0)
    seen = fate == BeamFate.RETURN
    reports.fate[0, beams] = fate
    reports.source[0, beams] = 0
    reports.measured_m[0, beams[seen]] = measured_m[seen]
    reports.intensity[0, beams[seen]] = np.pi * met.retro[seen, 0]
    reports.energy_fraction[0, beams[seen]] = share[seen]
    return reports


def _share_of_axis(met: Echoes, step_m: float, spacing_rad: float) -> Floats:
    """Share (beams,) of each spot on the surface that its axis meets; below 1 it lies across an edge.

    A further surface is one that lies deeper by more than ``step_m``, or by more than the tilt of the first one explains.
    """
    live = met.cosine > 0
    found = pulses(met, np.ones(live.shape), live, step_m, spacing_rad)
    share = np.zeros(len(live))
    on_axis = found.source == 0
    share[found.beam[on_axis]] = found.fraction[on_axis]
    return share


def _cut_off(model: PaperRanging, met: Echoes, drawn: Floats) -> Bools:
    """Beams (n,) that the dead zone swallows; ``drawn`` (n,): uniform numbers."""
    incidence = np.degrees(np.arccos(np.clip(met.cosine[:, 0].astype(np.float64), -1, 1)))
    odds = np.exp(np.clip((incidence - model.cutoff_deg) / model.cutoff_width_deg, -700, 700))
    return np.asarray(drawn * (1 + odds) > 1)
