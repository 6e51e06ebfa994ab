"""What papers printed for a case, to stand beside our figures."""

from pydantic import Field, model_validator

from benchmark.filter_states import KEYS
from scenes.errors import unknown
from scenes.spec import Positive, Spec, Vector3


class Published(Spec):
    """What a paper printed for a case, to stand beside our figures."""

    case: str
    source: str
    angle: str
    mean_deg: float
    max_deg: float


class PublishedRing(Spec):
    """What a paper printed for a stereo case: standard deviations of the motion from frame to frame, and seconds a frame.

    ``reason`` says why a figure is not met here, where one is not.
    """

    case: str
    source: str
    f2f_position_cm: Vector3
    f2f_rotation_deg: Vector3
    cpu_s: Positive | None = None
    reason: str = ""


class PublishedFilter(Spec):
    """What a paper printed for a LIDAR case: steady-state errors, 3σ, of the states that it gives.

    ``reasons`` say, state by state (``filter_states``), why a figure is not met here, where one is not.
    """

    case: str
    source: str
    attitude_deg: Positive | None = None
    omega_rad_s: Positive | None = None
    p: Positive | None = None
    r_m: Positive | None = None
    v_m_s: Positive | None = None
    q_pb_rad: Positive | None = None
    rho_m: Positive | None = None
    reasons: dict[str, str] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _reasons_are_of_states(self) -> "PublishedFilter":
        for key in self.reasons:
            if key not in KEYS:
                raise ValueError(f"reasons: {unknown('state', key, KEYS)}")
        return self

    @property
    def figures(self) -> dict[str, float | None]:
        """State → 3σ, in the state's unit."""
        printed = (self.attitude_deg, self.omega_rad_s, self.p, self.r_m, self.v_m_s, self.q_pb_rad, self.rho_m)
        return dict(zip(KEYS, printed, strict=True))
