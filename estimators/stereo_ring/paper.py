"""``stereo-ring-paper``: Shu, Pei, Ding, Duan & Zhou 2020 as printed, the baseline.

Arc-support ellipses in both views → in the first frame the largest pair whose centres match, then the ellipse nearest to 36
followed points, or the fit to these → normals of both cones, their mean; triangulated ellipse centres → dark regions that match,
the one nearest to the ring → the frame of eqs (8) and (9). Without a ring: the frame of three markers, eq. (13).

Where the printed text cannot be meant, this is what was mended:

1. Eq. (1): u_1, v_1 are u_l, v_l. M is K [I | 0] and K [R | T].
2. Section 2.2: "P seen at e_r" is p_l; e_l and e_r are the epipoles.
3. Eq. (2): R T is the product of a matrix with a vector; meant is F = K_r⁻ᵀ [T]× R K_l⁻¹.
4. Eq. (3): "dx" is Dx.
5. Eq. (5): a and b need A + C > 0; θ is ½ atan2(−B, C − A). As printed it is the wrong axis for every second ellipse.
6. D_th = 0.05 has no unit: in pixels it would refuse every frame, so it is read as a share of the radius.
7. Eq. (6): "curvature" is a fill ratio; its box has to count its pixels, or squares along them are refused (``count_box_pixels``).
8. Section 2.3.2: the label starts at −1, and N is an area, a number of regions and an index.
9. Eq. (8): n_x is projected into the ring's plane, else a marker off that plane gives no rotation.
10. Eq. (10): arctan(a, b) is atan2; angles near ±180° must not be subtracted.
11. Before eq. (11): "feature vectors λ" are eigenvalues; the signature must be (+, +, −).
12. Eq. (11): (λ1 − λ2)/(λ1 − λ2) = 1 is (λ1 − λ2)/(λ1 − λ3).
13. Eq. (12): n_r = Rᵀ ζ_r, if R is that of (2); both normals face the camera before they are compared; the mean is made a unit.
14. Eq. (13): n_z is used before it is defined, is no unit vector and has no sign.

What the paper leaves open: how X0 is found. It matches the ellipses' centres, so these are triangulated. They are not images of
the circle's centre: a bias towards the far side of 2 r² tan(toe-in)/baseline at any range, 18 cm for its rig and a ring of 0.6 m,
which noise from frame to frame cannot show; and their epipolar lines miss by up to 3.4 px, which ``centre_epipolar_px`` allows.
``centre_mode`` = "pole" takes the images of the centre.

Known properties, not faults: the largest ellipse is often the ring's shadow; followed points drift; the frame of (13) is not the
ring's; and nearest to the ring is another marker when one is not seen.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from estimators.api import Estimate, Outcome
from estimators.stereo_ring.circle_pair import circle_of_pair
from estimators.stereo_ring.conics import conic_from_ellipse
from estimators.stereo_ring.detector import detect_ellipses
from estimators.stereo_ring.frame_axes import ring_frame
from estimators.stereo_ring.marker_pairs import MarkerPairs, frame_of_markers, marker_pairs, nearest_to_ring
from estimators.stereo_ring.paper_parameters import PaperParameters
from estimators.stereo_ring.regions import marker_centres
from estimators.stereo_ring.ring_choice import Choice, followed, outermost_pair
from estimators.stereo_ring.setting import Picture, Setting, setting_from
from estimators.stopwatch import Stopwatch
from scenes.recording import Knowledge, Observation


@dataclass(frozen=True, slots=True, eq=False)
class _Last:
    """Both pictures of the last frame with a ring, and the ring in them."""

    pictures: tuple[Picture, Picture]
    choices: tuple[Choice, Choice]


class PaperRing:
    """The estimator; keyword arguments override ``PaperParameters``."""

    def __init__(self, **parameters: object) -> None:
        """Raises ``pydantic.ValidationError`` for an unknown or impossible parameter."""
        self.parameters = PaperParameters.model_validate(parameters)

    def start(self, knowledge: Knowledge) -> None:
        """Raises ``ValueError`` if the ring, the pair or one of its sensors is not in ``knowledge``."""
        self._setting: Setting = setting_from(knowledge)
        self._last: _Last | None = None

    def step(self, observation: Observation) -> Estimate:
        """One frame: section 2.3.1, then 2.3.2, then 2.4."""
        pictures = self._setting.pictures(observation)
        if isinstance(pictures, str):
            return self._failed(Outcome.SKIPPED, pictures, {})
        for name, picture in zip(self._setting.names, pictures, strict=True):
            if int(picture.max()) - int(picture.min()) < self.parameters.min_contrast_dn:
                return self._failed(Outcome.NO_FEATURES, f"the picture of {name!r} is blank", {})
        watch = Stopwatch()
        rings = self._rings(pictures, watch)
        pairs = self._markers(pictures)
        watch.ends("markers")
        extras = {"markers": float(len(pairs)), "from_ring": float(rings is not None)} | watch.extras
        return self._without_ring(pairs, extras) if rings is None else self._with_ring(rings, pairs, extras)

    def _rings(self, pictures: tuple[Picture, Picture], watch: Stopwatch) -> tuple[Choice, Choice] | None:
        """The ring in both views, remembered with copies of its pictures; None and nothing remembered where it is lost."""
        last, p = self._last, self.parameters
        left, right = (detect_ellipses(picture, p) for picture in pictures)
        watch.ends("detect")
        chosen = None
        if last is not None:
            tracks = [
                followed(last.pictures[view], pictures[view], last.choices[view].ellipse, found, p)
                for view, found in enumerate((left, right))
            ]
            chosen = (tracks[0], tracks[1]) if tracks[0] is not None and tracks[1] is not None else None
        rings = chosen or outermost_pair(self._setting.rig, left, right, p.centre_epipolar_px)
        self._last = None if rings is None else _Last((_owned(pictures[0]), _owned(pictures[1])), rings)
        watch.ends("track")
        return rings

    def _markers(self, pictures: tuple[Picture, Picture]) -> MarkerPairs:
        left, right = (marker_centres(picture, self.parameters.regions) for picture in pictures)
        return marker_pairs(self._setting.rig, left, right, self.parameters.marker_epipolar_px)

    def _with_ring(self, rings: tuple[Choice, Choice], pairs: MarkerPairs, extras: dict[str, float]) -> Estimate:
        left, right = (choice.ellipse for choice in rings)
        extras = extras | _ring_extras(rings)
        rig, mode = self._setting.rig, self.parameters.centre_mode
        circle = circle_of_pair(rig, conic_from_ellipse(left), conic_from_ellipse(right), mode)
        if circle is None:
            self._last = None
            return self._failed(Outcome.NOT_CONVERGED, "the two ellipses are of no one circle in front of the cameras", extras)
        extras = extras | {"radius_m": circle.radius_m}
        marker = nearest_to_ring(pairs, left, right)
        if marker is None:
            return self._failed(Outcome.NO_FEATURES, "no marker is seen in both pictures, so the turn is not known", extras)
        frame = ring_frame(circle.centre_m, circle.normal, marker)
        if frame is None:
            return self._failed(Outcome.NOT_CONVERGED, "the marker lies on the ring's axis, so the turn is not known", extras)
        return self._answer(frame, extras)

    def _without_ring(self, pairs: MarkerPairs, extras: dict[str, float]) -> Estimate:
        frame = frame_of_markers(pairs) if self.parameters.fallback else None
        if frame is None:
            return self._failed(Outcome.NO_FEATURES, f"no ring, and {len(pairs)} marker matches make no frame", extras)
        return self._answer(frame, extras)

    def _answer(self, left_from_ring: RigidTransform, extras: dict[str, float]) -> Estimate:
        answer = self._setting.left_from_target(left_from_ring)
        return Estimate(self._setting.names[0], Outcome.OK, answer.rotation, np.asarray(answer.translation), extras=extras)

    def _failed(self, outcome: Outcome, reason: str, extras: dict[str, float]) -> Estimate:
        return Estimate(self._setting.names[0], outcome, reason=reason, extras=extras)


def _ring_extras(rings: tuple[Choice, Choice]) -> dict[str, float]:
    extras: dict[str, float] = {}
    for view, choice in zip(("left", "right"), rings, strict=True):
        names = ("x_px", "y_px", "a_px", "b_px", "theta_rad")
        extras |= {f"{view}_{name}": float(value) for name, value in zip(names, choice.ellipse.parameters, strict=True)}
        extras[f"{view}_from_flow"] = float(choice.from_flow)
    return extras


def _owned(picture: NDArray[np.uint8]) -> Picture:
    return picture.copy()
