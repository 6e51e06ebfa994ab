"""Before hours are spent: what a rendering will cost, and what is wrong with it that a few frames tell."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from renderer.masks import Light
from renderer.photograph import Photograph, Photographer
from renderer.photometry import photometry
from renderer.quality import PRESETS, Preset
from renderer.scan_plan import scan_plan
from renderer.window import refuse_fast_spin
from scenes.arrays import Floats
from scenes.emitter import Patches
from scenes.errors import UsageError
from scenes.inside import is_inside
from scenes.quaternion import quaternion_notes
from scenes.scenario import Scenario, Scene, realize
from scenes.solids import Solid, bounding_points, solids

_TRIAL = Preset(1, 0, denoise_indirect=False)
_TRIAL_FRAMES = 3
_ENOUGH = 3  # frames that must all fail before a rendering is refused: one alone may be meant
_LOOKS = 64  # frames whose geometry is looked at
_ALL_OF_IT = 0.95  # of the pixels that the key light reaches; some at the silhouette hold little of the target
# CPU seconds, measured with LLVM on one core of 2020s server hardware; other machines differ by a factor of two.
_SAMPLE_S = {"disk": 1.0e-7, "patches": 1.8e-7}  # per pixel on the target and sample of direct light
_BOUNCE_S = 1.7e-7  # per pixel and sample of indirect light
_FILTER_S = 2.8e-6  # per pixel
_PICTURE_S = 1.2e-7  # per pixel of the whole picture: noise, conversion, files
_TARGET_BYTES, _PICTURE_BYTES = 38.0, 0.35  # per pixel of the target and of the picture


@dataclass(frozen=True, slots=True)
class Plan:
    """What is ahead: ``frames`` × ``sensors`` pictures, about ``cpu_s`` and ``disk_bytes``; ``warnings`` are whole sentences.

    ``scans``: numbers in one scan of each LIDAR.
    """

    frames: int
    sensors: int
    cpu_s: float
    disk_bytes: float
    warnings: tuple[str, ...]
    scans: tuple[int, ...] = ()

    def sentence(self) -> str:
        """The plan as a person reads it."""
        hours, minutes = divmod(round(self.cpu_s / 60), 60)
        time = f"{hours} h {minutes} min" if hours else f"{minutes} min" if minutes else f"{max(self.cpu_s, 1):.0f} s"
        size = f"{self.disk_bytes / 1e9:.1f} GB" if self.disk_bytes > 1e9 else f"{max(self.disk_bytes / 1e6, 1):.0f} MB"
        cameras = f"{self.sensors} camera{'' if self.sensors == 1 else 's'}" if self.sensors or not self.scans else ""
        points = " + ".join(f"{beams:,}" for beams in self.scans)
        lidars = f"{len(self.scans)} LIDAR{'s' if len(self.scans) > 1 else ''} ({points} points)" if self.scans else ""
        sensors = " and ".join(text for text in (cameras, lidars) if text)
        return f"{self.frames} frames × {sensors}, about {time} of CPU and {size} of disk"


def plan(scenario: Scenario, frames: range) -> Plan:
    """Looks at the geometry of some frames, renders three roughly and scans a few.

    Raises ``UsageError`` naming the field: a light inside of the target, a rig that never has the target in both pictures, an
    exposure that saturates the target in every frame tried or leaves it without light, a LIDAR that never meets it.
    """
    refuse_fast_spin(scenario)
    looks = [realize(scenario, scenario.seed, frame) for frame in _some(frames, _LOOKS)]
    refuse_lights_inside(scenario, looks)
    warnings = [*quaternion_notes(scenario), *_unseen(scenario, looks)]
    cost_s, size = 0.0, 0.0
    for name in scenario.sensors:
        photographer = Photographer(scenario, name, _TRIAL)
        tried = [(frame, photographer.take(realize(scenario, scenario.seed, frame))) for frame in _some(frames, _TRIAL_FRAMES)]
        warnings += _exposure_faults(scenario, name, tried)
        covered = float(np.mean([photo.layers["coverage"].sum() for _, photo in tried]))
        cost_s += _cost_s(scenario, name, covered)
        camera = scenario.sensors[name]
        size += _TARGET_BYTES * covered + _PICTURE_BYTES * camera.width_px * camera.height_px
    scans = [scan_plan(scenario, name, list(frames)) for name in scenario.lidars]
    cost_s, size = (sum(costs) for costs in zip((cost_s, size), *((one.cpu_s, one.disk_bytes) for one in scans)))
    warnings += [warning for one in scans for warning in one.warnings]
    points = tuple(one.beams for one in scans)
    return Plan(len(frames), len(scenario.sensors), cost_s * len(frames), size * len(frames), tuple(warnings), points)


def refuse_lights_inside(scenario: Scenario, scenes: list[Scene]) -> None:
    """Raises ``UsageError`` where a lamp or panel stands inside of a part of the target."""
    bodies = solids(scenario.target)
    for scene in scenes:
        for light in scene.lights:
            patches = light.emitter.centres_target if isinstance(light.emitter, Patches) else np.empty((0, 3))
            for solid in _around(bodies, patches):
                raise UsageError(f"lights.{light.name}: in frame {scene.frame} it stands inside the target's part {solid.name!r}")


def _around(bodies: tuple[Solid, ...], places: Floats) -> Iterator[Solid]:
    yield from (solid for solid in bodies for place in places if is_inside(solid, place))


def _unseen(scenario: Scenario, scenes: list[Scene]) -> Iterator[str]:
    """For each rig: in how many frames its pictures do not both hold the whole target. Raises where no pair holds any of it."""
    points = bounding_points(scenario.target)
    enough = len(scenes) >= _ENOUGH
    for name, rig in scenario.rigs.items():
        seen = np.array([[_share_seen(scenario, sensor, scene, points) for sensor in rig.sensors(name)] for scene in scenes])
        both = seen.min(axis=1)
        if enough and not both.any():
            raise UsageError(
                f"rigs.{name}: in none of the {len(scenes)} frames looked at is the target in both pictures; "
                f"look at toe_in_deg ({rig.toe_in_deg:g}), baseline_m ({rig.baseline_m:g}) and the motion's position"
            )
        cut = int(np.count_nonzero(both < 1))
        if cut:
            yield f"rigs.{name}: in {cut} of {len(scenes)} frames looked at a picture does not hold the whole target"


def _share_seen(scenario: Scenario, sensor: str, scene: Scene, points_target: Floats) -> float:
    """Which share of the box around the target's outline falls into one camera's picture; a box larger than that is cut too."""
    camera = scenario.sensors[sensor]
    points_cam = (camera.mount.chaser_from_cam.inv() * scene.chaser_from_target).apply(points_target)
    before = points_cam[points_cam[:, 2] > 0]
    if not len(before):
        return 0.0
    pixels = before[:, :2] / before[:, 2:] * [camera.intrinsics.fx_px, camera.intrinsics.fy_px]
    pixels += [camera.intrinsics.cx_px, camera.intrinsics.cy_px]
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    size = np.array([camera.width_px, camera.height_px])
    inside = np.clip(np.minimum(high, size - 0.5) - np.maximum(low, -0.5), 0, None)
    return float(np.prod(inside / np.maximum(high - low, 1e-9)))


def _exposure_faults(scenario: Scenario, name: str, tried: list[tuple[int, Photograph]]) -> Iterator[str]:
    """Warns of frames that are all white or all black. Raises where all are."""
    field = f"{scenario.field_of(name)}.exposure"
    tried = [(frame, photo) for frame, photo in tried if (photo.layers["coverage"] > 0).any()]
    brightest_dn = [_brightest_dn(scenario, name, photo) for _, photo in tried]
    faults = {
        "saturates all that is lit": [frame for frame, photo in tried if _is_white(photo)],
        "gives the target no light that the camera could see": [
            frame for (frame, _), most_dn in zip(tried, brightest_dn) if most_dn < 1
        ],
    }
    for what, found in faults.items():
        listed = ", ".join(str(frame) for frame in found)
        if found and len(found) == len(tried) >= _ENOUGH:
            raise UsageError(f"{field}: {name} {what} in every frame tried ({listed}); change the exposure or the light")
        if found:
            yield f"{field}: {name} {what} in frame {listed}"


def _is_white(photo: Photograph) -> bool:
    """Whether nearly all that the key light reaches is saturated."""
    mask = photo.layers["mask"]
    lit = mask[(mask & np.uint32(Light.LIT)) > 0]
    return bool(lit.size) and float(np.mean((lit & np.uint32(Light.SATURATED)) > 0)) >= _ALL_OF_IT


def _brightest_dn(scenario: Scenario, name: str, photo: Photograph) -> float:
    """How far above black the brightest hundredth of the target's pixels lies, without noise."""
    camera, spectrum = scenario.sensors[name], scenario.radiance_spectrum
    light = sum(photo.layers[layer] for layer in ("direct_diffuse", "direct_specular", "indirect"))
    radiance = float(np.percentile(np.asarray(light)[photo.layers["coverage"] > 0], 99))
    return radiance * photometry(camera, spectrum).electrons_per_radiance * photo.exposure_s * camera.detector.gain_dn_per_e


def _cost_s(scenario: Scenario, name: str, covered_px: float) -> float:
    """CPU seconds of one picture with ``covered_px`` pixels on the target."""
    preset, camera = PRESETS[scenario.quality], scenario.sensors[name]
    each = preset.indirect_samples * _BOUNCE_S + (_FILTER_S if preset.denoise_indirect else 0.0)
    near = [isinstance(light.emitter, Patches) for light in realize(scenario, scenario.seed, 0).lights]
    direct_s = sum(preset.direct_samples * _SAMPLE_S["patches" if one else "disk"] for one in near)
    return covered_px * (direct_s + each * len(near)) + _PICTURE_S * camera.width_px * camera.height_px


def _some(frames: range, most: int) -> list[int]:
    """The first, the last and evenly spaced frames between them, at most ``most``."""
    count = min(most, len(frames))
    return [frames[round(index * (len(frames) - 1) / max(count - 1, 1))] for index in range(count)]
