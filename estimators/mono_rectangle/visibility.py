"""Is this line really the rectangle's edge? An edge that cannot be told from its surroundings is dropped, never guessed."""

from dataclasses import dataclass

from estimators.mono_rectangle.edge_refit import EdgeFit
from estimators.mono_rectangle.parameters import TrackedParameters


@dataclass(frozen=True, slots=True)
class GreyScale:
    """The ends of the sensor's scale, DN."""

    black_dn: float
    white_dn: float


def why_invisible(fit: EdgeFit, grey: GreyScale, free_standing: bool, parameters: TrackedParameters) -> str:
    """The reason why a fitted line is not taken for an edge, or "" if it is one.

    A free-standing rectangle has open space outside: an edge with light on both sides is an occluder's, and what else runs
    along it is its own thickness. Any other has neighbours, whose edges must not be mixed with its own.
    """
    step_dn = fit.polarity * (fit.inner_dn - fit.outer_dn)
    least_dn = parameters.min_step * (grey.white_dn - grey.black_dn)
    outer, inner = fit.outer_dn - grey.black_dn, fit.inner_dn - grey.black_dn
    if not step_dn >= least_dn:
        return f"its step of {step_dn:.1f} DN is below {least_dn:.1f} DN"
    if fit.support < parameters.min_support:
        return f"only {fit.support:.0%} of it is seen, below {parameters.min_support:.0%}"
    allowed_px = max(parameters.max_scale_px, parameters.max_scale_over_noise * fit.noise_scale_px)
    if fit.scale_px > allowed_px:
        return f"it is ragged by {fit.scale_px:.2f} px, above {allowed_px:.2f} px"
    if not (fit.is_plain or free_standing):
        return "another edge runs along it within a few pixels"
    if free_standing and outer > parameters.max_outer_ratio * inner:
        return f"outside it is {outer:.0f} DN bright, inside {inner:.0f} DN: something else stands there"
    return ""
