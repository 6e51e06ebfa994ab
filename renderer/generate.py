"""Scenario + frames → data set: the only loop over frames."""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from renderer import worker
from renderer.emitters import apparent_radius_rad
from renderer.masks import Light
from renderer.photograph import Photographer
from renderer.processes import done_in_processes
from renderer.quality import PRESETS
from renderer.ranging import Scanner
from renderer.variant import Backend, probe
from renderer.window import refuse_fast_spin
from scenes.beam_fate import BeamFate
from scenes.dataset_frame import FrameRecord
from scenes.dataset_lidar import chaser_entry, lidar_entry
from scenes.dataset_manifest import Manifest, calibration, rig_entry
from scenes.dataset_writer import DatasetWriter
from scenes.errors import UsageError
from scenes.lighting import SceneLight
from scenes.scenario import Quality, Scenario, Scene, realize
from scenes.spectrum import band_irradiance

Progress = Callable[[int, int], None]


def generate(
    scenario: Scenario,
    out: Path,
    *,
    frames: range | None = None,
    seed: int | None = None,
    workers: int = 1,
    resume: bool = False,
    quality: Quality | None = None,
    progress: Progress | None = None,
) -> None:
    """Renders ``frames`` (default: all) of ``scenario`` into the data set folder ``out``.

    ``seed`` and ``quality`` replace the scenario's own. The bytes do not depend on ``workers``, order or interruptions.
    ``progress(done, total)`` is called after each frame. Raises ``DatasetConflict`` where ``out`` holds something else.
    """
    scenario = settled(scenario, seed, quality)
    selected = frames if frames is not None else range(scenario.frame_count)
    if not selected or min(selected) < 0 or max(selected) >= scenario.frame_count:
        raise UsageError(f"frames {selected}: the scenario has frames 0 to {scenario.frame_count - 1}")
    refuse_fast_spin(scenario)
    writer = DatasetWriter.open(out, manifest_of(scenario, selected, probe()), resume=resume)
    missing = writer.missing()
    report = progress or (lambda _done, _total: None)
    done = len(selected) - len(missing)
    report(done, len(selected))
    for _ in _rendered(writer, scenario, missing, workers):
        done += 1
        report(done, len(selected))
    writer.finish()


def settled(scenario: Scenario, seed: int | None, quality: Quality | None) -> Scenario:
    """``scenario`` with the seed and the quality that are given in place of its own."""
    changes: dict[str, Any] = {} if seed is None else {"seed": seed}
    changes |= {} if quality is None else {"quality": quality}
    return scenario.model_copy(update=changes)


def manifest_of(scenario: Scenario, frames: range, backend: Backend) -> Manifest:
    """What the data set will say of itself; nothing in it names this machine."""
    preset = {"name": scenario.quality} | asdict(PRESETS[scenario.quality])
    llvm = Path(backend.llvm_path).name if backend.llvm_path else None
    return Manifest.of(
        scenario=scenario.model_dump(mode="json"),
        seed=scenario.seed,
        frames=frames,
        sensors={name: _sensor(scenario, name) for name in scenario.sensors}
        | {name: _lidar(scenario, name) for name in scenario.lidars},
        backend={"variant": backend.variant, "llvm": llvm},
        quality=preset,
    )


def _sensor(scenario: Scenario, name: str) -> dict[str, Any]:
    """Calibration, and what the numbers in the truth layers mean."""
    from renderer.photometry import photometry

    camera = scenario.sensors[name]
    per_radiance = photometry(camera, scenario.radiance_spectrum).electrons_per_radiance
    rig_name = next((one for one, rig in scenario.rigs.items() if name in rig.sensors(one)), None)
    in_rig = {} if rig_name is None else {"rig": rig_entry(scenario.rigs[rig_name], rig_name, name)}
    return calibration(
        camera.model,
        bits=camera.detector.bits,
        electrons_per_second_per_radiance=per_radiance,
        psf_sigma_px=camera.detector.psf_sigma_px,
        parts=_parts(scenario),
        mask_bits={bit.name.lower(): int(bit) for bit in Light if bit.name},
        **in_rig,
    )


def _lidar(scenario: Scenario, name: str) -> dict[str, Any]:
    """Calibration, and what the numbers in the truth of its beams mean."""
    lidar = scenario.lidars[name]
    return lidar_entry(
        lidar.model,
        returns=lidar.returns,
        wavelength_nm=lidar.beam.wavelength_nm,
        parts=_parts(scenario),
        reasons={fate.name.lower(): int(fate) for fate in BeamFate if fate is not BeamFate.NO_SECOND or lidar.blocks > 1},
    )


def _parts(scenario: Scenario) -> list[str]:
    return ["background", *(part.name for part in scenario.target.parts)]


class FrameMaker:
    """Everything that renders one scenario in one process."""

    def __init__(self, scenario: Scenario) -> None:
        """Loads each camera's session and each LIDAR's beams."""
        self._scenario = scenario
        self._photographers = {name: Photographer(scenario, name) for name in scenario.sensors}
        self._scanners = {name: Scanner(scenario, name) for name in scenario.lidars}

    def record(self, frame: int) -> FrameRecord:
        """Every camera's picture and every LIDAR's scan of one frame, with the truth of both."""
        scene = realize(self._scenario, self._scenario.seed, frame)
        taken = {name: photographer.take(scene) for name, photographer in self._photographers.items()}
        scanned = {name: scanner.take(scene) for name, scanner in self._scanners.items()}
        motion = self._scenario.trajectory.truth_columns(scene.time_s, self._scenario.seed)
        rows = {name: photo.truth for name, photo in taken.items()} | {name: sounding.truth for name, sounding in scanned.items()}
        return FrameRecord(
            frame=frame,
            time_s=scene.time_s,
            images={name: photo.pixels for name, photo in taken.items()},
            layers={name: photo.layers for name, photo in taken.items()},
            truth={name: row | motion for name, row in rows.items()},
            state=self._state(scene, {name: photo.exposure_s for name, photo in taken.items()}),
            windows={name: photo.window for name, photo in taken.items()},
            scans={name: sounding.scan for name, sounding in scanned.items()},
            scan_truth={name: sounding.beams for name, sounding in scanned.items()},
        )

    def _state(self, scene: Scene, exposure_s: dict[str, float]) -> dict[str, Any]:
        lights = {light.name: _light_state(light, scene.time_s, exposure_s) for light in scene.lights}
        state = {"lights": lights, "exposure_s": exposure_s, "omega_target_rad_s": list(scene.omega_target_rad_s)}
        chaser = self._scenario.trajectory.chaser_state(scene.time_s, self._scenario.seed)
        return state if chaser is None else state | {"chaser": chaser_entry(chaser)}


def _light_state(light: SceneLight, time_s: float, exposure_s: dict[str, float]) -> dict[str, Any]:
    """A light's place and radiometry as truth: direction, position if it has one, in-band irradiance at the target's origin."""
    near = {} if light.position_chaser is None else {"position_chaser_m": light.position_chaser.tolist()}
    return near | {
        "direction_chaser": light.direction_chaser.tolist(),
        "direction_target": light.direction_target.tolist(),
        "half_angle_rad": apparent_radius_rad(light.emitter),
        "irradiance_w_m2": band_irradiance(light.irradiance_w_m2_nm),
        "power_factor": {name: light.power_factor(time_s, open_s) for name, open_s in exposure_s.items()},
    }


def _rendered(writer: DatasetWriter, scenario: Scenario, frames: Sequence[int], workers: int) -> Iterator[int]:
    """Renders and writes ``frames``, here or in worker processes, and yields each as it is published."""
    if not frames:
        return
    if workers == 1:
        maker = FrameMaker(scenario)
        for frame in frames:
            writer.write(maker.record(frame))
            yield frame
        return
    job = _Job(writer, scenario, threads=max(1, (os.cpu_count() or 1) // workers))
    yield from _in_processes(job, frames, workers)


@dataclass(frozen=True, slots=True)
class _Job:
    writer: DatasetWriter
    scenario: Scenario
    threads: int


def _in_processes(job: _Job, frames: Sequence[int], workers: int) -> Iterator[int]:
    """Fresh processes (Mitsuba cannot be forked). A worker that dies ends the run; finished frames stay."""
    advice = "finished frames are kept, go on with --resume"
    for frame, _ in done_in_processes(_work, frames, workers, _start_worker, (job,), advice):
        yield frame


_worker: dict[str, Any] = {}  # one process, one job


def _start_worker(job: _Job) -> None:
    worker.start(job.threads)
    _worker.update(writer=job.writer, maker=FrameMaker(job.scenario))


def _work(frame: int) -> None:
    _worker["writer"].write(_worker["maker"].record(frame))
