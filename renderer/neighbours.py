"""The picture of a frame as it would be from poses close by: what a camera's noise-free signal tells of the pose."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from renderer.photograph import Photographer
from renderer.quality import Preset
from scenes.arrays import Floats
from scenes.emitter import DistantDisk, Emitter, Patches
from scenes.lighting import SceneLight, scene_light
from scenes.scenario import Scenario, Scene, realize


def moved(pose: RigidTransform, xi: Floats) -> RigidTransform:
    """``pose`` after ξ = (ω, δt) in the axes it leads to: R ← exp(ω) R about the target's origin, t ← t + δt."""
    return RigidTransform.from_components(pose.translation + xi[3:], Rotation.from_rotvec(xi[:3]) * pose.rotation)


class Neighbours:
    """One camera of a scenario that looks at a frame from the frame's own pose and from others close to it.

    The target is moved before the chaser; lights that belong to the chaser stay with it, those that belong to the target go along.
    """

    def __init__(self, scenario: Scenario, name: str, direct_samples: int) -> None:
        """``direct_samples``: of each pixel. Indirect light, which varies slowly, is left out."""
        self._scenario, self._camera = scenario, scenario.sensors[name]
        self._photographer = Photographer(scenario, name, Preset(direct_samples, 0, denoise_indirect=False))
        self._cam_from_chaser = self._camera.mount.chaser_from_cam.inv()

    def electrons(self, frame: int, steps: Sequence[Floats], exposure_s: float, sampling_seed: int) -> Floats:
        """(len(steps), h, w) mean photo-electrons of the window that the frame is published in, float64.

        ``steps``: ξ (6,) each, camera axes. All share the random numbers of ``sampling_seed``, so that they differ by the pose
        alone and not by the noise of the rendering.
        """
        scene = realize(self._scenario, self._scenario.seed, frame)
        shown = [self._photographer.mean_electrons(self._stepped(scene, xi), scene, exposure_s, sampling_seed) for xi in steps]
        return np.asarray(shown, dtype=np.float64)

    def relit_electrons(self, frame: int, turns: Sequence[Floats], exposure_s: float, sampling_seed: int) -> Floats:
        """As ``electrons``, of the frame's own pose with its key light turned about the target's origin.

        ``turns``: rotation vectors (3,) in camera axes, rad; the other lights stay.
        """
        scene = realize(self._scenario, self._scenario.seed, frame)
        shown = [self._photographer.mean_electrons(self._relit(scene, one), scene, exposure_s, sampling_seed) for one in turns]
        return np.asarray(shown, dtype=np.float64)

    def across_light(self, frame: int) -> Floats:
        """(2, 3) unit vectors across the direction of the key light and each other, camera axes: what to turn it about."""
        scene = realize(self._scenario, self._scenario.seed, frame)
        towards = self._cam_from_chaser.rotation.apply(np.array(scene.lights[0].direction_chaser))
        return np.asarray(np.linalg.svd(towards[None])[2][1:])

    def image_motion_px(self, frame: int) -> Floats:
        """(6,) how far the fastest of the target's outermost points moves in the picture, per radian or metre of each of ξ."""
        scene = realize(self._scenario, self._scenario.seed, frame)
        return self._photographer.image_motion_px(self._cam_from_chaser * scene.chaser_from_target)

    def _relit(self, scene: Scene, turn: Floats) -> Scene:
        """``scene`` with its key light turned before this camera."""
        attitude = (self._cam_from_chaser * scene.chaser_from_target).rotation
        in_target = Rotation.from_rotvec(attitude.inv().apply(turn))
        in_chaser = Rotation.from_rotvec(self._cam_from_chaser.rotation.inv().apply(turn))
        return replace(scene, lights=(_turned(scene.lights[0], in_target, in_chaser), *scene.lights[1:]))

    def _stepped(self, scene: Scene, xi: Floats) -> Scene:
        """``scene`` with the target moved by ξ before this camera."""

        def stepped(pose: RigidTransform) -> RigidTransform:
            return self._cam_from_chaser.inv() * moved(self._cam_from_chaser * pose, xi)

        pose, lights, seed = stepped(scene.chaser_from_target), self._scenario.lights, self._scenario.seed
        return replace(
            scene,
            chaser_from_target=pose,
            pose_at=lambda instant_s: stepped(scene.pose_at(instant_s)),
            lights=tuple(scene_light(light.name, lights[light.name], pose, seed, scene.frame) for light in scene.lights),
        )


def _turned(light: SceneLight, in_target: Rotation, in_chaser: Rotation) -> SceneLight:
    """``light`` after one turn about the target's origin, given in both frames; where it stands in the chaser's is left out."""
    emitter: Emitter
    turn = in_target.as_matrix()
    match light.emitter:
        case DistantDisk() as disk:
            emitter = replace(disk, direction_target=turn @ disk.direction_target)
        case Patches() as patches:
            centres, u, v = (one @ turn.T for one in (patches.centres_target, patches.u_target, patches.v_target))
            emitter = replace(patches, centres_target=centres, u_target=u, v_target=v)
    return replace(
        light,
        emitter=emitter,
        direction_target=turn @ light.direction_target,
        direction_chaser=in_chaser.as_matrix() @ light.direction_chaser,
        position_chaser=None,
    )
