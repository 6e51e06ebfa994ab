"""What one camera of a rig sees and the other cannot, because it lies beside the other's picture."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from scenes.exr import Window
from scenes.intrinsics import Intrinsics


def outside_of_partner(
    z_m: NDArray[np.float32], window: Window, lens: Intrinsics, partner_from_cam: RigidTransform, partner_lens: Intrinsics
) -> NDArray[np.bool_]:
    """Pixels (h, w) of ``window`` whose point at depth ``z_m`` (0 = background) falls outside of the partner's picture."""
    rows, columns = np.nonzero(z_m > 0)
    pixels = np.column_stack([columns + window.x_px, rows + window.y_px]).astype(np.float64)
    normalised = lens.normalised_from_pixels(pixels)
    points_cam = np.column_stack([normalised, np.ones(len(rows))]) * z_m[rows, columns, None].astype(np.float64)
    seen = partner_lens.project(partner_from_cam.apply(points_cam))
    size = np.array([partner_lens.width_px, partner_lens.height_px])
    outside = np.zeros(z_m.shape, dtype=np.bool_)
    outside[rows, columns] = ~np.all((seen >= -0.5) & (seen < size - 0.5), axis=1)  # NaN, behind it, is outside
    return outside
