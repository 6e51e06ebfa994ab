"""Noise of ranges, strengths and false alarms against the formulae, by Monte Carlo over the pixels of a flash."""

import math

import numpy as np
import pytest
from oracles.soundings import BEAM, NAME, QUIET, lidar, measured_m, scenario, share, sounding
from oracles.studio import LAMBERT, box, still
from scipy.stats import kstest

from renderer.ranging import Sounding
from scenes.arrays import Floats
from scenes.beam_fate import BeamFate
from scenes.constants import SPEED_OF_LIGHT_M_S
from scenes.scenario import Scenario

MANY = {"type": "flash", "columns": 128, "rows": 128, "field_deg": (0.2, 0.2)}
COUNT = 128 * 128
FINE = {"divergence_mrad": 0.01, "sub_rays": 7}
FIVE_SIGMA = 5 / math.sqrt(2 * COUNT)  # of a standard deviation from so many samples
PULSE_SIGMA_M = SPEED_OF_LIGHT_M_S / 2 * QUIET["pulse_width_s"] / (2 * math.sqrt(2 * math.log(2)))


def _plate(
    ranging: dict[str, object],
    distance_m: float = 20.0,
    angle_deg: float = 0.0,
    beam: dict[str, object] | None = None,
    **changes: object,
) -> Scenario:
    plate = box((20.0, 20.0, 0.2), LAMBERT, centre_m=(0.0, 0.0, 0.1))
    device = lidar(ranging, beam or FINE, pattern=MANY, **changes)
    return scenario([plate], device, still(distance_m, (0.0, angle_deg, 0.0)))


def _errors_m(one: Sounding) -> Floats:
    return np.asarray(measured_m(one) - one.beams["range_m"])


@pytest.mark.parametrize("pulse_j", [1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize(("noise_e", "excess"), [(0.0, 1.0), (60.0, 1.0), (60.0, 4.0)])
def test_range_noise_grows_as_the_signal_falls(pulse_j: float, noise_e: float, excess: float):
    """σ = σ_pulse · √(F N + σ_e²) / N: with shot noise alone σ_pulse / √N."""
    one = sounding(_plate({"pulse_energy_j": pulse_j, "noise_e": noise_e, "excess_noise": excess, "threshold_e": 1.0}))
    electrons = float(np.median(one.beams["electrons"]))
    predicted = PULSE_SIGMA_M * math.sqrt(excess * electrons + noise_e**2) / electrons
    if noise_e == 0:
        assert predicted == pytest.approx(PULSE_SIGMA_M / math.sqrt(electrons))
    errors = _errors_m(one)
    # The receiver goes by the electrons that it counts; their own scatter adds at most 2 (σ_e / N)².
    assert np.nanstd(errors) == pytest.approx(predicted, rel=FIVE_SIGMA + 2 * (excess * electrons + noise_e**2) / electrons**2)
    assert abs(np.nanmean(errors)) < 5 * predicted / math.sqrt(COUNT)


def test_the_footprint_stretches_the_pulse():
    """At 75 deg a spot of 4 mrad at 20 m adds R · Δ/4 · tan θ to the pulse's own width, with seven sub-rays and with one."""
    stretch_m = 20.0 * 4e-3 / 4 * math.tan(math.radians(75.0))
    for sub_rays in (1, 7, 19):
        wide = {"divergence_mrad": 4.0, "sub_rays": sub_rays}
        one = sounding(_plate({"pulse_energy_j": 1e-3, "pulse_width_s": 0.5e-9}, 20.0, 75.0, wide))
        electrons = float(np.median(one.beams["electrons"]))
        predicted = math.hypot(PULSE_SIGMA_M / 8, stretch_m) / math.sqrt(electrons)
        assert stretch_m > PULSE_SIGMA_M / 8
        assert np.std(_errors_m(one)) == pytest.approx(predicted, rel=FIVE_SIGMA + 0.04)


def test_the_clock_and_the_rounding_add_up():
    jitter_s, step_m = 200e-12, 0.05  # steps below two sigma: the sum of variances is exact to 1e-3 (Sheppard)
    case = _plate({"pulse_energy_j": 1.0, "jitter_s": jitter_s, "range_step_m": step_m, "intensity_step_e": 1000.0})
    one = sounding(case)
    ranges = measured_m(one)
    assert np.abs(ranges / step_m - np.rint(ranges / step_m)).max() < 1e-4
    assert (one.scan.intensity % 1000 == 0).all()
    predicted = math.hypot(SPEED_OF_LIGHT_M_S / 2 * jitter_s, step_m / math.sqrt(12))
    assert np.std(_errors_m(one)) == pytest.approx(predicted, rel=FIVE_SIGMA)
    assert case.lidars[NAME].model.range_sigma_m > predicted


def test_the_stated_sigma_is_that_of_a_return_ten_times_above_threshold():
    case = _plate({"noise_e": 30.0, "jitter_s": 30e-12})
    electrons = float(np.median(sounding(case).beams["electrons"]))
    fitted = _plate({"noise_e": 30.0, "jitter_s": 30e-12, "pulse_energy_j": QUIET["pulse_energy_j"] * 500 / electrons})
    assert np.std(_errors_m(sounding(fitted))) == pytest.approx(fitted.lidars[NAME].model.range_sigma_m, rel=0.06)


def test_counted_electrons_have_shot_noise():
    one = sounding(_plate({"pulse_energy_j": 1e-3, "noise_e": 20.0, "excess_noise": 3.0, "threshold_e": 1.0}))
    excess = one.scan.intensity - one.beams["electrons"]
    predicted = 3.0 * float(one.beams["electrons"].mean()) + 400.0
    assert np.var(excess) == pytest.approx(predicted, rel=2 * FIVE_SIGMA)


def test_half_of_the_returns_are_seen_at_the_threshold():
    at = float(np.median(sounding(_plate({"threshold_e": 1.0})).beams["electrons"]))
    for times, least, most in ((0.5, 1.0, 1.0), (1.0, 0.45, 0.55), (1.5, 0.0, 0.0)):
        seen = share(sounding(_plate({"threshold_e": times * at, "noise_e": 0.05 * at})), BeamFate.RETURN)
        assert least <= round(seen, 3) <= most


def test_false_alarms_are_as_many_as_stated_and_evenly_spread():
    empty = scenario(
        [box((1.0, 1.0, 1.0), LAMBERT)],
        lidar({"false_alarm_probability": 0.1, "noise_e": 10.0}, FINE, pattern=MANY, gate_m=(5.0, 45.0)),
        still(-10.0),
    )
    one = sounding(empty)
    alarms = one.beams["reason"] == BeamFate.FALSE_ALARM
    assert alarms.mean() == pytest.approx(0.1, abs=5 * math.sqrt(0.1 * 0.9 / COUNT))
    assert one.truth["false_alarms"] == alarms.sum()
    assert one.truth["returns"] == 0
    ranges = measured_m(one)[alarms]
    assert kstest((ranges - 5.0) / 40.0, "uniform").pvalue > 1e-3
    assert (one.scan.intensity[alarms] >= QUIET["threshold_e"]).all()
    assert np.isnan(one.beams["range_m"]).all()


def test_a_nearer_false_alarm_wins_only_where_the_first_return_is_asked_for():
    often = {"false_alarm_probability": 0.5, "noise_e": 5.0}
    for returns, wanted in (("strongest", 0.0), ("first", 0.5 * (20.0 - 5.0) / (45.0 - 5.0))):
        one = sounding(_plate(often, gate_m=(5.0, 45.0), returns=returns))
        assert share(one, BeamFate.FALSE_ALARM) == pytest.approx(wanted, abs=0.02)


def _paper(**model: object) -> Scenario:
    return _plate({"type": "paper"} | model, beam=BEAM)


def test_the_paper_s_noise_is_gaussian_with_its_sigma():
    errors = _errors_m(sounding(_paper(sigma_m=0.05))).ravel()
    assert np.std(errors) == pytest.approx(0.05, rel=FIVE_SIGMA)
    assert kstest(errors / 0.05, "norm").pvalue > 1e-3


@pytest.mark.parametrize("angle_deg", [70.0, 75.0, 80.0])
def test_the_paper_s_dead_zone_is_logistic(angle_deg: float):
    case = _plate({"type": "paper", "sigma_m": 0.0, "cutoff_deg": 75.0, "cutoff_width_deg": 3.0}, 20.0, angle_deg, BEAM)
    removed = share(sounding(case), BeamFate.CUT_OFF)
    predicted = 1 / (1 + math.exp(-(angle_deg - 75.0) / 3.0))
    assert removed == pytest.approx(predicted, abs=5 * math.sqrt(0.25 / COUNT) + 0.004)  # the field is 0.2 deg wide


def test_the_paper_s_edges_are_noisier():
    """A plate's rim and a step are edges; its tilted middle is none, at any angle."""
    parts = [
        box((1.0, 1.0, 0.2), LAMBERT, centre_m=(0.0, 0.0, 0.1)),
        box((0.4, 0.4, 0.3), LAMBERT, "block", centre_m=(0.0, 0.0, -0.15)),
    ]
    field = {"type": "flash", "columns": 128, "rows": 128, "field_deg": (4.0, 4.0)}
    model = {"type": "paper", "sigma_m": 0.01, "edge_sigma_m": 0.2}
    case = scenario(parts, lidar(model, BEAM | {"divergence_mrad": 0.8}, pattern=field), still(20.0))
    one = sounding(case)
    errors, seen = _errors_m(one), one.beams["reason"] == BeamFate.RETURN
    x, y = (np.abs(one.beams["deskewed_m"][..., axis]) for axis in (0, 1))
    spot_m = 20.0 * 0.4e-3
    rim = np.minimum(np.abs(x - 0.5), np.abs(y - 0.5)) < 0.5 * spot_m
    middle = (x < 0.15) & (y < 0.15)
    assert np.std(errors[seen & rim]) == pytest.approx(math.hypot(0.01, 0.2), rel=0.2)
    assert np.std(errors[seen & middle]) == pytest.approx(0.01, rel=0.2)
    tilted = _plate({"type": "paper", "sigma_m": 0.01, "edge_sigma_m": 0.2}, 20.0, 80.0, BEAM)
    assert np.std(_errors_m(sounding(tilted))) == pytest.approx(0.01, rel=FIVE_SIGMA)


def test_noise_of_a_beam_does_not_depend_on_what_others_meet():
    """The same beam has the same noise whether or not the target fills the rest of the field."""
    model = {"type": "paper", "sigma_m": 0.05}
    small = box((0.02, 0.02, 0.2), LAMBERT, centre_m=(0.0, 0.0, 0.1))
    alone = scenario([small], lidar(model, BEAM, pattern=MANY), still(20.0))
    partly, whole = sounding(alone), sounding(_paper(sigma_m=0.05))
    seen = np.isfinite(partly.scan.intensity)
    assert 0 < seen.sum() < COUNT
    assert _errors_m(partly)[seen] == pytest.approx(_errors_m(whole)[seen], abs=1e-5)
