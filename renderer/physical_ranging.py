"""What a pulsed receiver reports of each beam: pulses, noise, threshold, the returns that are asked for, the dropouts explained."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from renderer.beams import Echoes
from renderer.candidates import Candidates, Noise, candidates
from renderer.pulses import Pulses, pulses
from renderer.receiver import Receiver
from renderer.reports import Reports
from scenes.arrays import Bools, Floats
from scenes.beam_fate import BeamFate


def physical_reports(receiver: Receiver, echoes: Echoes, sun_w_m2_nm: float, seed: int, frame: int, name: str) -> Reports:
    """(blocks, beams) of reports; ``sun_w_m2_nm``: irradiance of sunlight at the laser's wavelength."""
    lidar, model = receiver.lidar, receiver.model
    alarms = model.false_alarm_probability > 0
    noise = Noise.of(seed, frame, name, echoes.cosine.shape, alarms=alarms)
    reports = Reports.empty(lidar.blocks, len(echoes.cosine))
    beams = np.flatnonzero((echoes.cosine > 0).any(axis=1))
    met = echoes.rows(beams)
    live = (met.cosine > 0) & (met.range_m >= lidar.gate_m[0]) & (met.range_m <= lidar.gate_m[1])
    found = pulses(met, receiver.electrons(met), live, model.resolution_m, lidar.beam.spacing_rad)
    if lidar.beam.sub_rays == 1:
        found = replace(found, stretch_m=_unresolved_stretch_m(found, met, lidar.beam.sigma_rad))
    _explain(reports, receiver, met, beams, live, found)
    offered = candidates(model, found, beams, receiver.background_e(met, sun_w_m2_nm), lidar.gate_m, noise)
    for block, chosen in enumerate(_chosen(lidar.returns, offered)):
        _deliver(reports, block, receiver, offered, chosen, found, noise)
    met_something = reports.fate[0] != BeamFate.NOTHING
    reports.fate[1:, met_something] = _without_second(reports.fate[1:, met_something])
    return reports


def _without_second(fate: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Fates of further blocks of beams that the first block says something of."""
    return np.where(fate == BeamFate.NOTHING, np.uint8(BeamFate.NO_SECOND), fate)


def _chosen(policy: str, offered: Candidates) -> list[NDArray[np.int64]]:
    """For each block, which candidates are delivered. Where the last is the strongest, the next strongest goes with it."""
    if policy == "first":
        return [offered.first_by(offered.range_m)]
    if policy == "last":
        return [offered.first_by(-offered.range_m)]
    strongest = offered.first_by(-offered.counted_e)
    if policy == "strongest":
        return [strongest]
    others = np.setdiff1d(np.arange(len(offered.beam)), strongest)
    last_is_strongest = np.isin(offered.beam, offered.beam[np.intersect1d(strongest, offered.first_by(-offered.range_m))])
    key = np.where(last_is_strongest, -offered.counted_e, -offered.range_m)
    return [strongest, others[offered.only(others).first_by(key[others])]]


def _deliver(
    reports: Reports,
    block: int,
    receiver: Receiver,
    offered: Candidates,
    chosen: NDArray[np.int64],
    found: Pulses,
    noise: Noise,
) -> None:
    """Writes the chosen returns, as the receiver rounds them, with what is true of them."""
    model, beam, pulse = receiver.model, offered.beam[chosen], offered.pulse[chosen]
    measured_m = offered.range_m[chosen] + offered.sigma_m[chosen] * noise.range[block, beam]
    reports.measured_m[block, beam] = _rounded(measured_m, model.range_step_m)
    reports.intensity[block, beam] = _rounded(offered.counted_e[chosen], model.intensity_step_e)
    reports.fate[block, beam] = np.where(pulse >= 0, BeamFate.RETURN, BeamFate.FALSE_ALARM)
    real, pulse = beam[pulse >= 0], pulse[pulse >= 0]
    reports.electrons[block, real] = found.electrons[pulse]
    reports.energy_fraction[block, real] = found.fraction[pulse]
    reports.source[block, real] = found.source[pulse]


def _explain(reports: Reports, receiver: Receiver, met: Echoes, beams: NDArray[np.int64], live: Bools, found: Pulses) -> None:
    """Fills the first block as if no beam had a return: why not, and what is true of its strongest pulse.

    Too weak is what a matt surface of the same albedo would not have been (the light went elsewhere), or what would not have been
    if it faced the beam (too grazing), or else too dark or far. All that a spot meets is counted together.
    """
    threshold_e = receiver.model.threshold_e
    total_e, matt_e, face_on_e = (
        np.where(live, electrons, 0.0).sum(axis=1)
        for electrons in (receiver.electrons(met), receiver.matt_electrons(met), receiver.face_on_electrons(met))
    )
    weak = total_e < threshold_e
    causes = [~live.any(axis=1), weak & (matt_e >= threshold_e), weak & (face_on_e >= threshold_e)]
    fate = np.select(causes, [BeamFate.GATED, BeamFate.MIRROR, BeamFate.GRAZING], BeamFate.DARK)
    reports.fate[0, beams] = fate
    reports.source[0, beams] = np.argmax(met.cosine > 0, axis=1)
    by_strength = np.argsort(found.electrons, kind="stable")  # the strongest is written last
    reports.electrons[0, beams[found.beam[by_strength]]] = found.electrons[by_strength]


def _unresolved_stretch_m(found: Pulses, met: Echoes, sigma_rad: float) -> Floats:
    """1σ of range over the spot of a beam with one sub-ray: R σ tan θ, as of a plane."""
    cosine = np.clip(met.cosine[found.beam, 0].astype(np.float64), 0.01, 1)
    return np.asarray(found.range_m * sigma_rad * np.sqrt(1 - cosine**2) / cosine)


def _rounded(values: Floats, step: float) -> Floats:
    return np.rint(values / step) * step if step > 0 else values
