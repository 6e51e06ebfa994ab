"""A pulsed receiver: how many photo-electrons come back from what a beam meets."""

import math
from dataclasses import dataclass

import numpy as np

from renderer.beams import Echoes
from renderer.laser_line import LaserLine, Surfaces, surfaces
from scenes.arrays import Floats
from scenes.lidar import Lidar
from scenes.ranging_model import PhysicalRanging
from scenes.target import Target


@dataclass(frozen=True, slots=True, eq=False)
class Receiver:
    """One physical receiver behind its optics.

    ``scale_e_m2``: photo-electrons of a sub-ray whose surface has BSDF · cosine = 1 sr⁻¹ at 1 m: pulse energy per sub-ray ·
    aperture area · τ η λ / (h c). ``sun_e``: electrons during a pulse of a surface lit by the sun with BSDF · cosine = 1 sr⁻¹
    per W m⁻² nm⁻¹ of sunlight.
    """

    lidar: Lidar
    model: PhysicalRanging
    surfaces: Surfaces
    scale_e_m2: float
    sun_e: float

    @classmethod
    def of(cls, lidar: Lidar, model: PhysicalRanging, target: Target) -> "Receiver":
        """The receiver of ``lidar``. A pulse's energy is shared by the beams of a flash, and by the sub-rays of a beam."""
        beam, beams = lidar.beam, lidar.pattern.beams
        shares = beams.time_s.size // beams.pulses * beam.sub_rays
        per_joule = model.electrons_per_joule(beam.wavelength_nm)
        field_rad = model.receiver_field_mrad * 1e-3 or beam.divergence_rad
        etendue_m2_sr = model.aperture_m2 * math.pi / 4 * field_rad**2
        return cls(
            lidar=lidar,
            model=model,
            surfaces=surfaces(target, LaserLine(beam.wavelength_nm)),
            scale_e_m2=model.pulse_energy_j / shares * model.aperture_m2 * per_joule,
            sun_e=etendue_m2_sr * model.filter_width_nm * model.pulse_width_s * per_joule,
        )

    def electrons(self, echoes: Echoes) -> Floats:
        """The lidar equation for a surface that fills its sub-ray: E f cos(θ) A / R² · τ η λ / (h c), (beams, sub-rays).

        Wagner et al. 2006 (ISPRS J. Photogramm. 60, 100), eq. (3), with the surface's BSDF in the place of its cross section.
        """
        return self._spread(np.asarray(echoes.retro, np.float64), echoes)

    def face_on_electrons(self, echoes: Echoes) -> Floats:
        """The same if every surface faced the beam."""
        return self._spread(self.surfaces.face_on[echoes.part], echoes)

    def matt_electrons(self, echoes: Echoes) -> Floats:
        """The same if every surface were Lambertian with its own albedo: f = albedo / π."""
        return self._spread(self.surfaces.albedo[echoes.part] / np.pi * echoes.cosine, echoes)

    def background_e(self, echoes: Echoes, sun_w_m2_nm: float) -> Floats:
        """Expected electrons of sunlight within a pulse, (beams,): radiance · étendue · filter · pulse · τ η λ / (h c)."""
        if echoes.sunlit is None:
            return np.zeros(len(echoes.range_m))
        return np.asarray(self.sun_e * sun_w_m2_nm * echoes.sunlit.mean(axis=1, dtype=np.float64))

    def _spread(self, value: Floats, echoes: Echoes) -> Floats:
        """``value`` (BSDF · cosine) as electrons; nothing comes from where a ray meets nothing or an inside."""
        seen = echoes.cosine > 0
        range_m = np.where(seen, echoes.range_m, np.float32(1.0)).astype(np.float64)
        return np.asarray(np.where(seen, self.scale_e_m2 * value / range_m**2, 0.0))
