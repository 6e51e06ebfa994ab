"""``mono-rectangle-paper``: Zhai, Qu, Li & Chen 2014 as printed, the baseline.

Canny → Hough (1 px, 1°, in a band about each expected edge) → four vertices → eqs (8)-(17) → the Z→Y→X angles. No size, no
filter, no sub-pixel refinement, no check of what the edges are. The expected edges are those of the last frame that was
answered; in the first frame, the operator's corners.

Where the printed text cannot be meant, this is what was mended:

1. Eq. (10): its result is named b and must be c; its denominator has (u2 − u1) and must have (u2 − u4). As printed it
   is wrong by half in the median. c plays no part in the rotation, only in telling crossed quadrilaterals.
2. "from O_cX_c… to O_eX_e…": O_e is O_t, and the direction is the other one: Rx Ry Rz leads from target to camera.
3. arctan must be atan2 (arctan alone fails on half of all visible attitudes), and "|R13| = 1" must be a tolerance.
4. The axis whose name is missing is O_cX_c: along the optical axis, pointing backwards. Then x_1c < 0, as the minus
   signs of (13)-(16) need, and v must point UP in the image.
5. "Radius 53.59 m" is the full width that is seen, 2·100·tan 15°.
6. d = (S_H − 30) r/(2 tan 15°): the 30 are pixels of the display, unexplained; with them d = 615.79 mm.
7. The means of the results have no sign: 0.05° beside a maximum of 3° can only be signed.

A known property, not a fault: with 1° steps the two long sides of the small face are almost always found exactly parallel,
so the perspective, hence the tilt, is lost and the answer is 0 in most frames (the whole convergence is 1.2 px of 65).
"""

import numpy as np
from scipy.spatial.transform import Rotation

from estimators.api import Estimate, Outcome
from estimators.mono_rectangle.angles import rotation_from_zyx, zyx_from_cam_rotation, zyx_from_rotation
from estimators.mono_rectangle.closed_form import aspect_ratio, is_possible
from estimators.mono_rectangle.hough_edges import hough_lines
from estimators.mono_rectangle.paper_form import PAPER_FROM_CV, paper_from_normalised, paper_rotation
from estimators.mono_rectangle.parameters import PaperParameters
from estimators.mono_rectangle.quadrilateral import EDGE_NAMES, intersections
from estimators.mono_rectangle.setting import Setting, setting_from
from scenes.arrays import Floats
from scenes.recording import Knowledge, Observation


class PaperRectangle:
    """The estimator; keyword arguments override ``PaperParameters``."""

    def __init__(self, **parameters: object) -> None:
        """Raises ``pydantic.ValidationError`` for an unknown or impossible parameter."""
        self.parameters = PaperParameters.model_validate(parameters)

    def start(self, knowledge: Knowledge) -> None:
        """Raises ``ValueError`` if the rectangle, the corner prior or its sensor is not in ``knowledge``."""
        self._setting: Setting = setting_from(knowledge)
        self._vertices_px = np.asarray(self._setting.prior.corners_px, dtype=np.float64)
        self._band_px = max(self.parameters.first_band_sigmas * self._setting.prior.sigma_px, self.parameters.band_px)

    def step(self, observation: Observation) -> Estimate:
        """One frame: the paper's figure 3."""
        pixels = self._setting.pixels(observation)
        if isinstance(pixels, str):
            return self._failed(Outcome.SKIPPED, pixels)
        lines = hough_lines(self._setting.eight_bit(pixels), self._vertices_px, self._band_px, self.parameters)
        missing = [name for name, line in zip(EDGE_NAMES, lines, strict=True) if line is None]
        if missing:
            return self._failed(Outcome.NO_FEATURES, f"no Hough line in the band about {', '.join(missing)}")
        vertices_px = intersections(np.array(lines))
        vertices = self._setting.sensor.intrinsics.normalised_from_pixels(vertices_px)
        if not is_possible(vertices):
            return self._failed(Outcome.NOT_CONVERGED, "the four lines are no rectangle seen from outside")
        self._vertices_px, self._band_px = vertices_px, self.parameters.band_px
        answer = self._rotation(vertices) * self._setting.rectangle.target_from_feature.inv()
        return Estimate(self._setting.sensor_name, Outcome.OK, answer, extras=self._extras(answer, vertices))

    def _rotation(self, vertices: Floats) -> Rotation:
        """Camera from feature, OpenCV axes: the paper's R_ct is not quite orthogonal, the rotation of its angles is."""
        focal_px = self._setting.sensor.intrinsics.fx_px
        R_ct = paper_rotation(paper_from_normalised(vertices, focal_px), focal_px)
        angles = zyx_from_rotation(R_ct, self.parameters.gimbal_tolerance)
        return Rotation.from_matrix(PAPER_FROM_CV.T @ rotation_from_zyx(angles))

    def _extras(self, cam_from_target: Rotation, vertices: Floats) -> dict[str, float]:
        """The angles, the aspect ratio and where the corners were found, in ideal pixels."""
        angles, lens = np.rad2deg(zyx_from_cam_rotation(cam_from_target)), self._setting.sensor.intrinsics
        extras = {f"theta{i + 1}_deg": float(angle) for i, angle in enumerate(angles)} | {"aspect": float(aspect_ratio(vertices))}
        corners_px = vertices * [lens.fx_px, lens.fy_px] + [lens.cx_px, lens.cy_px]
        named = ((f"p{number}_{axis}_px", value) for number, one in enumerate(corners_px, 1) for axis, value in zip("xy", one))
        return extras | {name: float(value) for name, value in named}

    def _failed(self, outcome: Outcome, reason: str) -> Estimate:
        return Estimate(self._setting.sensor_name, outcome, reason=reason)
