"""One beam of a LIDAR: its wavelength and the spot that it lights, as a handful of sub-rays of equal energy."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from scenes.arrays import Floats, frozen
from scenes.spec import Spec

# Sub-rays on the axis, on the inner hexagon, and on the outer ring of twelve.
_RINGS = {1: (1,), 7: (1, 6), 19: (1, 6, 12)}


class Beam(Spec):
    """What every beam of a LIDAR has in common.

    ``divergence_mrad``: full angle of the spot; of a ``gaussian`` one where its irradiance has fallen to 1/e² (ISO 11146), of a
    ``top-hat`` to its rim. For a pixel of a flash it is the pixel's own field. ``sub_rays``: the spot as 1, 7 or 19 rays, from
    which mixed pixels and split returns follow.
    """

    wavelength_nm: Annotated[float, Field(ge=300, le=2500)]
    divergence_mrad: Annotated[float, Field(ge=0, le=100)]
    profile: Literal["gaussian", "top-hat"] = "gaussian"
    sub_rays: Literal[1, 7, 19] = 7

    @property
    def divergence_rad(self) -> float:
        """The full angle."""
        return self.divergence_mrad * 1e-3

    @property
    def sigma_rad(self) -> float:
        """Standard deviation of the spot along one axis: a quarter of the full angle for both profiles."""
        return self.divergence_rad / 4

    @property
    def offsets_rad(self) -> Floats:
        """Where the sub-rays point, (sub_rays, 2) from the beam's axis along two axes across it, the axis itself first.

        Each stands for an equal share of the pulse. A ring stands for the annulus that holds its rays' share, at the annulus'
        root mean square radius; a last factor gives the whole the spot's own variance.
        """
        rings = _RINGS[self.sub_rays]
        within = np.cumsum(rings)[:-1] / self.sub_rays
        inner, outer = within, np.append(within[1:], 1.0)
        radii = np.sqrt([self._mean_square(low, high) for low, high in zip(inner, outer)])
        places = [np.zeros((1, 2))]
        for count, radius, order in zip(rings[1:], radii, range(len(radii))):
            angle = 2 * np.pi * (np.arange(count) + order / 2) / count
            places.append(radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1))
        offsets = np.concatenate(places)
        variance = np.mean(offsets[:, 0] ** 2)
        return frozen(offsets * (self.sigma_rad / np.sqrt(variance) if variance > 0 else 1.0))

    @property
    def spacing_rad(self) -> float:
        """The largest distance of a sub-ray from its nearest neighbour; 0 for one alone."""
        offsets = self.offsets_rad
        apart = np.linalg.norm(offsets[:, None] - offsets[None], axis=-1) + np.diag(np.full(len(offsets), np.inf))
        nearest = apart.min(axis=1)
        return float(nearest[np.isfinite(nearest)].max(initial=0.0))

    def _mean_square(self, low: float, high: float) -> float:
        """Mean of r² between the radii that hold the shares ``low`` and ``high`` of the energy, in units of 2σ²."""
        if self.profile == "top-hat":  # the share within r grows as r²
            return low + high
        # Gaussian: r²/2σ² is distributed exponentially.
        from_low, to_high = -np.log1p(-low), -np.log1p(-high) if high < 1 else np.inf
        tail = to_high * np.exp(-to_high) if np.isfinite(to_high) else 0.0
        upper = np.exp(-to_high) if np.isfinite(to_high) else 0.0
        return float(((from_low + 1) * np.exp(-from_low) - tail - upper) / (high - low))


def sub_ray_directions(axes_lidar: Floats, offsets_rad: Floats) -> Floats:
    """Unit vectors (beams, sub-rays, 3) about the beams' axes (beams, 3); offsets along (y × axis) and across it."""
    right = np.cross([0.0, 1.0, 0.0], axes_lidar)
    right /= np.linalg.norm(right, axis=-1, keepdims=True)
    down = np.cross(axes_lidar, right)
    off = offsets_rad[None, :, 0, None] * right[:, None] + offsets_rad[None, :, 1, None] * down[:, None]
    rays = axes_lidar[:, None] + off
    return np.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True))
