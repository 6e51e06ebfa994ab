"""Lights of a laboratory, in absolute units: a halogen lamp with its ripple, and luminous panels."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from scenes.arrays import Floats, frozen, unit
from scenes.draw import NonZeroVector3, PositiveScalar
from scenes.emitter import beam_solid_angle_sr
from scenes.incandescence import Ripple, planck_w_m2_sr_nm, share_per_nm
from scenes.spec import Fraction, NonNegative, Positive, Spec, Vector3
from scenes.spectrum import BAND_NM, NonNegativeQuantity, band_irradiance, on_band, sends_light

Frame = Literal["chaser", "target"]
Temperature = Annotated[float, Field(ge=800, le=20_000)]


class HalogenLamp(Spec):
    """A tungsten halogen lamp behind a round aperture of uniform radiance, with a beam.

    Of the electric ``power_w`` the share ``efficiency`` leaves the aperture as radiation, all wavelengths together, with the
    spectrum of tungsten at ``temperature_k``. Radiance is the same in all directions within a cone of full angle ``beam_deg``
    and falls to zero over the next ``edge_deg``. The axis points to ``aim_m``, left out: to the target's origin.
    ``position_m`` and ``aim_m`` are in ``frame`` axes. On alternating current the power swings by ``ripple_depth`` at twice
    ``mains_hz`` (0 Hz: direct current).
    """

    type: Literal["halogen"]
    description: str = ""
    source: str = ""
    frame: Frame = "chaser"
    position_m: Vector3
    aim_m: Vector3 | None = None
    radius_m: Positive = 0.05
    power_w: PositiveScalar
    efficiency: Annotated[float, Field(gt=0, le=1)] = 0.6
    temperature_k: Temperature = 3200.0
    beam_deg: Annotated[float, Field(gt=0, le=170)] = 60.0
    edge_deg: Annotated[float, Field(gt=0, le=60)] = 10.0
    mains_hz: NonNegative = 0.0
    ripple_depth: Fraction = 0.1
    ripple_phase_deg: float = 0.0

    @model_validator(mode="after")
    def _is_a_beam(self) -> "HalogenLamp":
        if self.beam_deg / 2 + self.edge_deg > 90:
            raise ValueError(f"beam_deg {self.beam_deg:g} with an edge of {self.edge_deg:g} deg reaches behind the lamp")
        if self.aim_m == self.position_m:
            raise ValueError(f"aim_m {self.aim_m} is the lamp's own position_m, so it points nowhere")
        return self

    @property
    def angles_rad(self) -> tuple[float, float]:
        """Where the beam begins to fall and where it ends, from the axis."""
        return math.radians(self.beam_deg / 2), math.radians(self.beam_deg / 2 + self.edge_deg)

    @property
    def spectrum(self) -> Floats:
        """Spectral radiance on ``BAND_NM`` for one watt of electric power, W m⁻² sr⁻¹ nm⁻¹."""
        flux = self.efficiency * share_per_nm(BAND_NM, self.temperature_k)
        return frozen(flux / (math.pi * self.radius_m**2 * beam_solid_angle_sr(*self.angles_rad)))

    @property
    def ripple(self) -> Ripple | None:
        """How the power swings; None on direct current."""
        if self.mains_hz == 0 or self.ripple_depth == 0:
            return None
        return Ripple(self.mains_hz, self.ripple_depth, math.radians(self.ripple_phase_deg))


class Panel(Spec):
    """A flat Lambertian source of ``width_m`` × ``height_m`` that shines along ``facing``, its width horizontal (chaser's x, z)."""

    centre_m: Vector3
    facing: NonZeroVector3
    width_m: Positive
    height_m: Positive

    @property
    def half_axes(self) -> tuple[Floats, Floats]:
        """Half the width and half the height as vectors whose cross product points along ``facing``."""
        normal = unit(self.facing)
        level = np.cross([0.0, 1.0, 0.0], normal)
        width = unit(level) if np.linalg.norm(level) > 1e-9 else np.array([1.0, 0.0, 0.0])
        return width * self.width_m / 2, np.cross(normal, width) * self.height_m / 2


class LightPanels(Spec):
    """Room light: Lambertian panels of equal radiance and one spectrum.

    ``flux_w``: radiant power of all panels together between 300 and 1100 nm. Its spectrum is that of a black body of
    ``temperature_k``, or any ``relative_spectrum``.
    """

    type: Literal["panels"]
    description: str = ""
    source: str = ""
    frame: Frame = "chaser"
    panels: Annotated[tuple[Panel, ...], Field(min_length=1, max_length=16)]
    flux_w: PositiveScalar
    temperature_k: Temperature = 4000.0
    relative_spectrum: Annotated[NonNegativeQuantity, AfterValidator(sends_light)] | None = None

    @property
    def spectrum(self) -> Floats:
        """Spectral radiance on ``BAND_NM`` for one watt of ``flux_w``, W m⁻² sr⁻¹ nm⁻¹: Φ = π L A."""
        given = self.relative_spectrum
        shape = planck_w_m2_sr_nm(BAND_NM, self.temperature_k) if given is None else on_band(given)
        area_m2 = sum(panel.width_m * panel.height_m for panel in self.panels)
        return frozen(shape / band_irradiance(shape) / (math.pi * area_m2))
