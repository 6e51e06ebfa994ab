import numpy as np
import pytest

from renderer.window import inside, margin_px, outline_px, place_window, refuse_fast_spin, survey, target_extent
from scenes.camera import Camera
from scenes.errors import UsageError
from scenes.scenario import Scenario
from scenes.solids import bounding_points

BORDER_PX = 3  # five sigmas of the camera below


def _camera(**changes) -> Camera:
    detector = {"quantum_efficiency": 0.5, "full_well_e": 1e4, "gain_dn_per_e": 0.1, "psf_sigma_px": 0.5}
    body = {"width_px": 640, "height_px": 480, "pixel_pitch_m": 5e-6, "focal_length_m": 0.002, "f_number": 4}
    return Camera.model_validate(body | {"detector": detector, "exposure": {"type": "fixed", "time_s": 1e-3}} | changes)


def _scenario(motion: dict, frames: int = 4, **camera) -> Scenario:
    paint = {"type": "paint", "source": "test", "reflectance": 0.5}
    part = {"name": "box", "shape": {"type": "box", "size_m": (2.0, 1.0, 0.5)}, "material": paint}
    return Scenario.model_validate(
        {
            "frame_count": frames,
            "target": {"parts": [part]},
            "cameras": {"cam": _camera(**camera)},
            "lights": {"sun": {"type": "sun", "direction": (0, 0, -1)}},
            "motion": motion,
        }
    )


@pytest.mark.parametrize("extent", [(0, 0, 0, 0), (639, 479, 639, 479), (100.2, 50.7, 180.9, 90.1), (0, 0, 639, 479)])
def test_a_window_stays_within_reach_of_the_picture_and_holds_what_it_can(extent: tuple[float, ...]):
    window = place_window(np.array(extent), (96, 64), _camera())
    assert min(window.x_px, window.y_px) >= -BORDER_PX
    assert window.x_px + 96 <= 640 + BORDER_PX
    assert window.y_px + 64 <= 480 + BORDER_PX
    part = inside(window, _camera())
    assert min(part.x_px, part.y_px) >= 0
    assert part.x_px + part.width_px <= 640
    assert part.y_px + part.height_px <= 480
    assert (part.x_px + part.width_px, part.y_px + part.height_px) > (window.x_px, window.y_px)
    if extent[2] - extent[0] < 90:
        assert window.x_px <= extent[0]
        assert window.x_px + 95 >= extent[2]
        assert window.y_px <= extent[1]
        assert window.y_px + 63 >= extent[3]


@pytest.mark.parametrize("distortion", [(0.0,) * 5, (-0.25, 0.06, 1e-3, -1e-3, 0.0), (0.2, 0.0, 0.0, 2e-3, 0.0)])
def test_the_outline_encloses_everything_between_the_points(distortion: tuple[float, ...]):
    lens = _camera(distortion=distortion).intrinsics
    rng = np.random.default_rng(0)
    corners = rng.uniform(-0.7, 0.7, (8, 2))
    share = rng.dirichlet(np.full(8, 0.3), 20000)
    pixels = lens.pixels_from_normalised(share @ corners)
    outline = outline_px(lens, corners)
    assert (pixels.min(axis=0) >= outline.min(axis=0) - 0.05).all()
    assert (pixels.max(axis=0) <= outline.max(axis=0) + 0.05).all()


def test_corners_alone_would_not_enclose_what_a_barrel_bends_outwards():
    lens = _camera(distortion=(-0.25, 0.06, 0.0, 0.0, 0.0)).intrinsics
    edge = np.array([[-0.7, 0.5], [0.7, 0.5]])
    assert lens.pixels_from_normalised(edge)[:, 1].max() + 10 < outline_px(lens, edge)[:, 1].max()


def test_a_target_beside_or_behind_the_camera_fills_the_picture():
    whole = [-BORDER_PX, -BORDER_PX, 639 + BORDER_PX, 479 + BORDER_PX]
    points = np.array([[0.0, 0.0, 5.0], [1.0, 0.0, -1.0]])
    assert target_extent(_camera(), points).tolist() == whole
    folding = _camera(distortion=(-0.2, 0.0, 0.0, 0.0, 0.0), focal_length_m=0.004)
    assert target_extent(folding, np.array([[0.0, 0.0, 5.0], [30.0, 0.0, 5.0]])).tolist() == whole


def test_the_size_holds_every_frame_and_depends_on_no_choice_of_frames():
    motion = {"type": "spin", "position_m": (-3.0, 0.0, 12.0), "velocity_m_s": (2.0, 0.5, -1.0), "omega_target_deg_s": (20, 30, 40)}
    case = _scenario(motion)
    camera = case.cameras["cam"]
    found = survey(case, camera)
    points = bounding_points(case.target)
    for frame in range(case.frame_count):
        extent = target_extent(camera, case.motion.chaser_from_target(float(frame), frame, 0).apply(points))
        window = place_window(extent, found.size, camera)
        margin = margin_px(camera) - 1
        assert window.x_px <= max(extent[0] - margin, 0)
        assert window.x_px + window.width_px - 1 >= min(extent[2] + margin, 639)
        assert window.y_px <= max(extent[1] - margin, 0)
        assert window.y_px + window.height_px - 1 >= min(extent[3] + margin, 479)
    assert all(edge % 16 == 0 for edge in found.size)


def test_motion_counts_in_any_frame_and_within_the_longest_exposure():
    still = {"type": "spin", "position_m": (0.0, 0.0, 1000.0)}
    assert not survey(_scenario(still), _camera()).moves
    # 1 m/s at 1000 m is 0.0004 px in a millisecond; ten frames at 99 m/s later the target is 9 m away.
    approach = still | {"velocity_m_s": (1.0, 0.0, -99.0)}
    assert not survey(_scenario(approach, frames=1), _camera()).moves
    assert survey(_scenario(approach, frames=11), _camera()).moves
    auto = {"exposure": {"type": "auto", "longest_s": 0.1}}
    slow = still | {"velocity_m_s": (1.0, 0.0, 0.0)}
    assert not survey(_scenario(slow), _camera()).moves
    case = _scenario(slow, **auto)
    assert survey(case, case.cameras["cam"]).moves


def test_a_blurred_target_gets_a_wider_window():
    spin = {"type": "spin", "position_m": (0.0, 0.0, 8.0), "velocity_m_s": (20.0, 0.0, 0.0)}
    long_exposure = {"exposure": {"type": "fixed", "time_s": 0.05}}
    narrow, wide = (survey(case, case.cameras["cam"]).size for case in (_scenario(spin, 1), _scenario(spin, 1, **long_exposure)))
    assert wide[0] >= narrow[0] + 32  # 1 m at 8 m and f = 400 px is 50 px
    assert wide[1] == narrow[1]


def test_a_mount_turns_what_the_camera_sees():
    aside = {"type": "spin", "position_m": (12.0, 0.0, 0.0)}
    mount = {"mount": {"rotation_vector_deg": (0.0, 90.0, 0.0)}}
    case = _scenario(aside, 1, **mount)
    ahead = _scenario({"type": "spin", "position_m": (0.0, 0.0, 12.0), "rotation_vector_deg": (0.0, -90.0, 0.0)}, 1)
    assert survey(case, case.cameras["cam"]) == survey(ahead, ahead.cameras["cam"])


def test_a_spin_that_the_blur_cannot_follow_is_refused_with_both_angles():
    motion = {"type": "spin", "position_m": (0.0, 0.0, 12.0), "omega_target_deg_s": (0, 0, 360)}
    refuse_fast_spin(_scenario(motion, exposure={"type": "fixed", "time_s": 0.1}))
    with pytest.raises(UsageError, match=r"cameras\.cam\.exposure: the target turns by 360 deg .* of 1 s, at most 57 deg"):
        refuse_fast_spin(_scenario(motion, exposure={"type": "fixed", "time_s": 1.0}))


def test_a_whole_turn_within_the_exposure_is_motion_although_it_ends_where_it_began():
    motion = {"type": "spin", "position_m": (0.0, 0.0, 12.0), "omega_target_deg_s": (0, 0, 360)}
    case = _scenario(motion, exposure={"type": "fixed", "time_s": 1.0})
    assert survey(case, case.cameras["cam"]).moves
