"""Scans on disk: PCD files that others read, the truth beside them, and data sets that hold LIDARs."""

import json

import numpy as np
import open3d as o3d
import pandas as pd
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from scenes.arrays import frozen
from scenes.beam_truth import decode_beams, encode_beams
from scenes.dataset import Dataset
from scenes.dataset_frame import FrameRecord
from scenes.dataset_layout import TRUTH_COLUMNS
from scenes.dataset_lidar import chaser_entry, chaser_state, is_lidar, lidar_entry, lidar_model
from scenes.dataset_verify import verify
from scenes.dataset_writer import DatasetWriter
from scenes.errors import DatasetConflict, DatasetError
from scenes.pcd import decode_scan, encode_scan
from scenes.pose_columns import pose_columns
from scenes.recording import ChaserState, LidarModel, Scan

ROWS, COLUMNS = 6, 9
MOUNT = RigidTransform.from_components([0.0, 0.1, 2.0], Rotation.from_rotvec([0.1, 0.2, 0.3]))
MODEL = LidarModel(ROWS, COLUMNS, MOUNT, 0.05, 1.36e-3, 1.0, 150.0, 0.2, 0.05)
CHASER = ChaserState(
    1.5, Rotation.from_rotvec([1.0, 2.0, 0.5]), frozen([7e6, 1.0, -2.0]), frozen([0.0, 7.5e3, 1.0]), frozen([0, 0, 1e-3])
)


def scan(frame: int, returns: float = 0.5) -> Scan:
    """A made-up scan."""
    rng = np.random.default_rng(frame)
    points = rng.normal(size=(ROWS, COLUMNS, 3)).astype(np.float32)
    intensity = rng.random((ROWS, COLUMNS)).astype(np.float32)
    none = rng.random((ROWS, COLUMNS)) >= returns
    points[none], intensity[none] = np.nan, np.nan
    return Scan(points, intensity, rng.normal(size=(ROWS, COLUMNS)).astype(np.float32))


def beams(frame: int) -> dict[str, np.ndarray]:
    """Made-up truth of its beams."""
    rng = np.random.default_rng(frame)
    reason, range_m = rng.integers(0, 8, (ROWS, COLUMNS), np.uint8), rng.random((ROWS, COLUMNS), np.float32)
    return {"range_m": range_m, "reason": reason, "deskewed_m": rng.random((ROWS, COLUMNS, 3), np.float32)}


def same(one: Scan, other: Scan) -> bool:
    return all(
        np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True) for name in ("points_lidar", "intensity", "time_s")
    )


@pytest.mark.parametrize("returns", [0.0, 0.3, 1.0])
def test_a_scan_comes_back_as_it_was(returns):
    given = scan(3, returns)
    back = decode_scan(encode_scan(given))
    assert same(back, given)
    assert back.points_lidar.shape == (ROWS, COLUMNS, 3)
    assert not back.points_lidar.flags.writeable
    assert encode_scan(given) == encode_scan(given)


def test_nan_is_written_with_the_same_bits_whatever_its_payload():
    given = scan(3)
    odd = given.points_lidar.copy()
    odd.view(np.uint32)[np.isnan(odd)] = 0xFFC12345
    assert encode_scan(Scan(odd, given.intensity, given.time_s)) == encode_scan(given)


def test_the_header_is_that_of_an_organised_pcd():
    lines = encode_scan(scan(1)).split(b"DATA binary_compressed\n")[0].decode().splitlines()
    header = dict(line.split(" ", 1) for line in lines)
    assert header["VERSION"] == "0.7"
    assert header["FIELDS"] == "x y z intensity t"
    assert (header["WIDTH"], header["HEIGHT"]) == (str(COLUMNS), str(ROWS))
    assert header["TYPE"] == "F F F F F"


def test_open3d_reads_the_scan(tmp_path):
    given = scan(7)
    (tmp_path / "scan.pcd").write_bytes(encode_scan(given))
    cloud = o3d.io.read_point_cloud(str(tmp_path / "scan.pcd"))
    assert np.array_equal(np.asarray(cloud.points, np.float32), given.points_lidar.reshape(-1, 3), equal_nan=True)
    tensors = o3d.t.io.read_point_cloud(str(tmp_path / "scan.pcd")).point
    assert np.array_equal(tensors["intensity"].numpy().ravel(), given.intensity.ravel(), equal_nan=True)
    assert np.array_equal(tensors["t"].numpy().ravel(), given.time_s.ravel())


WHOLE = encode_scan(scan(1))


@pytest.mark.parametrize("data", [b"", b"not a PCD", WHOLE[:-40], WHOLE.replace(b"intensity", b"intensitx")])
def test_a_broken_scan_is_refused(data):
    with pytest.raises(ValueError, match="not a readable scan"):
        decode_scan(data)


def test_truth_comes_back_as_it_was_in_the_same_bytes():
    given = beams(2)
    back = decode_beams(encode_beams(given))
    assert back.keys() == given.keys()
    assert all(np.array_equal(back[name], given[name]) and back[name].dtype == given[name].dtype for name in given)
    assert encode_beams(given) == encode_beams(dict(reversed(given.items())))
    with pytest.raises(ValueError, match="not a readable archive"):
        decode_beams(encode_beams(given)[:-30])


def test_a_calibration_comes_back_as_it_was(tiny):
    entry = json.loads(json.dumps(lidar_entry(MODEL, wavelength_nm=1064.0)))
    assert is_lidar(entry)
    assert not is_lidar(tiny.manifest().sensors["nav"])
    back = lidar_model(entry, "here")
    for name in ("rows", "columns", "range_sigma_m", "divergence_rad", "least_range_m", "most_range_m", "duration_s", "delay_s"):
        assert getattr(back, name) == getattr(MODEL, name)
    assert (back.chaser_from_lidar * MOUNT.inv()).as_matrix() == pytest.approx(np.eye(4))
    del entry["rows"]
    with pytest.raises(DatasetError, match="here: it is no LIDAR calibration"):
        lidar_model(entry, "here")


def test_the_chaser_s_state_comes_back_as_it_was():
    back = chaser_state(json.loads(json.dumps({"chaser": chaser_entry(CHASER)})), "here")
    assert back is not None
    assert back.time_s == 1.5
    assert (back.inertial_from_chaser * CHASER.inertial_from_chaser.inv()).magnitude() < 1e-15
    for name in ("position_inertial_m", "velocity_inertial_m_s", "omega_chaser_rad_s"):
        assert np.array_equal(getattr(back, name), getattr(CHASER, name))
    assert chaser_state({}, "here") is None
    with pytest.raises(DatasetError, match=r"here: state\.chaser"):
        chaser_state({"chaser": {"time_s": 1.0}}, "here")


def manifest(tiny, cameras: bool = False):
    both = {"lidar": lidar_entry(MODEL)} | (tiny.manifest().sensors if cameras else {})
    return tiny.manifest(sensors=both)


def record(tiny, frame: int, cameras: bool = False) -> FrameRecord:
    seen = tiny.record(frame)
    row = dict.fromkeys(TRUTH_COLUMNS, float("nan")) | pose_columns(tiny.pose(frame)) | {"returns": 3.0, "rel_x_m": 1.0}
    return FrameRecord(
        frame=frame,
        time_s=frame / 2,
        images=seen.images if cameras else {},
        layers=seen.layers if cameras else {},
        truth={"lidar": row} | (dict(seen.truth) if cameras else {}),
        state={"chaser": chaser_entry(CHASER)},
        scans={"lidar": scan(frame)},
        scan_truth={"lidar": beams(frame)},
    )


@pytest.fixture(params=[False, True], ids=["lidar-only", "with-cameras"])
def dataset(request, tiny, tmp_path) -> Dataset:
    """A whole data set of a LIDAR, alone or beside two cameras."""
    writer = DatasetWriter.open(tmp_path / "data", manifest(tiny, request.param))
    for frame in writer.missing():
        writer.write(record(tiny, frame, request.param))
    writer.finish()
    return Dataset.open(tmp_path / "data")


def test_an_observation_holds_scans_pictures_and_the_chaser(dataset):
    cameras = {"nav", "wide"} if dataset.sensors else set()
    seen = dataset.observation(5)
    assert dataset.lidars.keys() == {"lidar"} == seen.scans.keys()
    assert dataset.sensors.keys() == cameras == seen.images.keys()
    assert same(seen.scans["lidar"], scan(5))
    assert seen.chaser is not None
    assert seen.chaser.position_inertial_m.tolist() == [7e6, 1.0, -2.0]
    truth = dataset.scan_truth(5, "lidar")
    assert np.array_equal(truth["reason"], beams(5)["reason"])
    assert dataset.lidars["lidar"].range_sigma_m == 0.05


def test_the_table_has_a_row_a_sensor_and_the_motion_s_columns(dataset):
    table = dataset.truth_table()
    assert len(table) == len(dataset.frames) * len(dataset.manifest.sensors)
    of_lidar = table[table["sensor"] == "lidar"]
    assert (of_lidar["returns"] == 3.0).all()
    assert (of_lidar["rel_x_m"] == 1.0).all()
    assert pd.isna(of_lidar["lit_fraction"]).all()


def test_a_whole_data_set_has_no_fault_and_a_damaged_scan_is_found(dataset):
    assert verify(dataset.path) == []
    for name in ("lidar.pcd", "lidar_truth.npz"):
        file = dataset.path / "frames" / "000007" / name
        whole = file.read_bytes()
        file.write_bytes(whole[:-7])
        assert any(name in fault and "truncated or edited" in fault for fault in verify(dataset.path))
        with pytest.raises(DatasetError, match="truncated or edited"):
            dataset.observation(7) if name.endswith("pcd") else dataset.scan_truth(7, "lidar")
        file.write_bytes(whole)
    (dataset.path / "frames" / "000007" / "lidar.pcd").unlink()
    assert any("lidar.pcd: it is missing" in fault for fault in verify(dataset.path))


def test_an_interrupted_data_set_goes_on_and_another_lidar_is_refused(tiny, tmp_path):
    first = DatasetWriter.open(tmp_path / "data", manifest(tiny))
    first.write(record(tiny, 3))
    again = DatasetWriter.open(tmp_path / "data", manifest(tiny), resume=True)
    assert again.missing() == first.missing() == list(range(5, 23, 2))
    other = lidar_entry(LidarModel(ROWS, COLUMNS, MOUNT, 0.06, 1.36e-3, 1.0, 150.0))
    with pytest.raises(DatasetConflict, match=r"sensors\.lidar\.range_sigma_m: 0.05 in the folder, 0.06 asked for"):
        DatasetWriter.open(tmp_path / "data", tiny.manifest(sensors={"lidar": other}), resume=True)


@pytest.mark.parametrize("missing", ["scans", "scan_truth"])
def test_a_frame_without_its_scan_is_refused(tiny, tmp_path, missing):
    writer = DatasetWriter.open(tmp_path / "data", manifest(tiny))
    whole = record(tiny, 3)
    parts = {name: getattr(whole, name) for name in ("frame", "time_s", "images", "layers", "truth", "scans", "scan_truth")}
    with pytest.raises(ValueError, match="a frame has the sensors"):
        writer.write(FrameRecord(**(parts | {missing: {}})))


def test_a_scan_of_another_shape_is_refused(tiny, tmp_path):
    smaller = lidar_entry(LidarModel(2, 2, MOUNT, 0.05, 1e-3, 1.0, 150.0))
    one_frame = tiny.manifest(sensors={"lidar": smaller}, frames=range(3, 4))
    writer = DatasetWriter.open(tmp_path / "data", one_frame)
    writer.write(record(tiny, 3))
    writer.finish()
    with pytest.raises(DatasetError, match=r"its shape is \(6, 9\), not \(2, 2\)"):
        Dataset.open(tmp_path / "data").observation(3)
