"""What is read from a data set is what was written, bit by bit; what was changed is found out."""

import json
import shutil

import numpy as np
import pytest

from scenes.dataset import Dataset
from scenes.dataset_frame import FrameRecord
from scenes.dataset_layout import TRUTH_COLUMNS
from scenes.dataset_verify import verify
from scenes.errors import DatasetError
from scenes.pose_columns import pose_columns
from scenes.provenance import readable_json, sha256_of_json

FRAME = 9


@pytest.fixture
def dataset(dataset_path):
    return Dataset.open(dataset_path)


def test_frames_and_calibration_come_back(tiny, dataset):
    assert dataset.frames == list(range(3, 23, 2))
    assert dataset.identity == tiny.manifest().identity
    model = dataset.sensors["nav"]
    assert (model.black_dn, model.white_dn) == (6.0, 4095.0)
    assert (model.intrinsics.fy_px, model.intrinsics.distortion) == (101.0, (0.1, 0.0, 0.0, 0.0, 0.0))
    assert dataset.features[0].name == "face"
    assert dataset.features[0].gap == (0.4, 0.6)
    assert dataset.scenario == tiny.SCENARIO


def test_pictures_come_back_bit_by_bit(tiny, dataset):
    observation, record = dataset.observation(FRAME), tiny.record(FRAME)
    assert (observation.frame, observation.time_s) == (FRAME, 4.5)
    for camera, dtype in (("nav", np.uint16), ("wide", np.uint8)):
        pixels = observation.images[camera].pixels
        assert pixels.dtype == dtype
        assert not pixels.flags.writeable
        np.testing.assert_array_equal(pixels, record.images[camera])
        assert dataset.image_path(FRAME, camera).is_file()


def test_layers_come_back_bit_by_bit(tiny, dataset):
    layers, written = dataset.layers(FRAME, "nav"), tiny.record(FRAME).layers["nav"]
    assert layers.keys() == written.keys()
    for name, layer in layers.items():
        assert layer.dtype == written[name].dtype
        np.testing.assert_array_equal(layer.view(np.uint32), written[name].view(np.uint32))  # the sign of −0 too


def test_truth_comes_back_exactly(tiny, dataset):
    truth, record = dataset.truth(FRAME), tiny.record(FRAME)
    assert dict(truth.row["nav"]) == pytest.approx(dict(record.truth["nav"]), nan_ok=True, abs=0, rel=0)
    error = truth.sensor_from_target["nav"].inv() * tiny.pose(FRAME)
    assert error.rotation.magnitude() < 1e-15
    assert np.linalg.norm(error.translation) < 1e-13
    assert dataset.state(FRAME) == {"exposure_s": {"nav": 1e-4}}


def test_truth_table_has_a_row_per_frame_and_sensor(tiny, dataset):
    table = dataset.truth_table()
    assert list(table.columns) == ["frame", "sensor", "time_s", *TRUTH_COLUMNS, "theta_deg"]
    assert list(table["frame"]) == [frame for frame in dataset.frames for _ in range(2)]
    assert list(table["sensor"]) == ["nav", "wide"] * 10
    row = table[(table.frame == FRAME) & (table.sensor == "wide")].iloc[0]
    written = tiny.record(FRAME).truth["wide"]
    assert [row[name] for name in written] == pytest.approx(list(written.values()), nan_ok=True, abs=0, rel=0)
    norm = np.linalg.norm(table[["qw", "qx", "qy", "qz"]].to_numpy(), axis=1)
    assert np.abs(norm - 1).max() < 1e-15
    assert table.qw.min() >= 0


def test_pose_columns_take_the_half_of_the_quaternions_with_positive_qw(tiny):
    for frame in range(0, 100, 7):
        columns = pose_columns(tiny.pose(frame))
        assert columns["qw"] >= 0
        assert columns["tx_m"] == 0.1 * frame


def test_record_refuses_truth_that_is_not_one(tiny):
    good = dict(tiny.record(3).truth["nav"])
    for wrong, what in [({"qw": -good["qw"]}, "quaternion"), ({"qx": 3.0}, "quaternion"), ({"range_m": None}, "lacks range_m")]:
        truth = {name: value for name, value in {**good, **wrong}.items() if value is not None}
        with pytest.raises(ValueError, match=what):
            FrameRecord(3, 0.0, {}, {}, {"nav": truth})


@pytest.mark.parametrize(
    ("name", "text"),
    [("missing", "manifest.json is missing"), ("cut", "truncated or edited, not JSON"), ("other", "'other' version 1")],
)
def test_open_names_a_broken_manifest(dataset_path, name, text):
    file = dataset_path / "manifest.json"
    if name == "missing":
        file.unlink()
    elif name == "cut":
        file.write_bytes(file.read_bytes()[:100])
    else:
        file.write_text(file.read_text().replace("hardlight-dataset", "other"))
    with pytest.raises(DatasetError, match=text):
        Dataset.open(dataset_path)
    assert len(verify(dataset_path)) == 1


@pytest.mark.parametrize(("old", "new"), [('"seed": 7', '"seed": 8'), ('"rate_hz": 2.0', '"rate_hz": 3.0'), ("100.0", "100.5")])
def test_an_edited_manifest_is_refused_with_both_digests(dataset_path, old, new):
    file = dataset_path / "manifest.json"
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))
    with pytest.raises(DatasetError, match=r"states (digest|identity) \w{64}, its content has \w{64}: it was edited"):
        Dataset.open(dataset_path)


@pytest.mark.parametrize(
    ("key", "value", "text"),
    [
        ("seed", "7", r"seed: Input should be a valid integer \(got '7'\)"),
        ("frame_count", 11, "are not 11 frames"),
        ("stranger", 1, "stranger"),
        ("sensors", {"../nav": {}}, "sensors"),
        ("scenario", {"shape": {"type": "mesh", "path": "/etc/passwd"}}, "'/etc/passwd' does not lie in the data set"),
        ("scenario", {"shape": {"type": "mesh", "path": "assets/../../x.stl"}}, "does not lie in the data set"),
    ],
)
def test_a_forged_manifest_is_refused(dataset_path, key, value, text):
    file = dataset_path / "manifest.json"
    raw = json.loads(file.read_text())
    file.write_text(readable_json(raw | {key: value}))
    with pytest.raises(DatasetError, match=text):
        Dataset.open(dataset_path)


def test_open_says_which_frames_are_missing_and_what_to_do(dataset_path):
    for frame in (5, 21):
        shutil.rmtree(dataset_path / f"frames/{frame:06d}")
    with pytest.raises(DatasetError, match=r"2 of 10 frames are missing \(000005, 000021\); render them with --resume"):
        Dataset.open(dataset_path)


def test_open_wants_the_truth_table(dataset_path):
    (dataset_path / "truth.parquet").unlink()
    with pytest.raises(DatasetError, match=r"truth\.parquet is missing; write it with --resume"):
        Dataset.open(dataset_path)


def test_a_frame_outside_is_refused(dataset):
    with pytest.raises(DatasetError, match=r"no frame 4, only range\(3, 23, 2\)"):
        dataset.observation(4)


@pytest.mark.parametrize("name", ["nav.png", "nav_truth.exr", "frame.json"])
@pytest.mark.parametrize("harm", ["missing", "truncated", "edited"])
def test_harm_to_a_file_is_found_by_reading_and_by_verify(dataset, name, harm):
    file = dataset.path / f"frames/000009/{name}"
    data = file.read_bytes()
    if harm == "missing":
        file.unlink()
    else:
        middle = len(data) // 2
        file.write_bytes(data[:-7] if harm == "truncated" else data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :])
    with pytest.raises(DatasetError, match=f"000009/{name}: "):
        dataset.layers(FRAME, "nav") if name.endswith("exr") else dataset.observation(FRAME)
    faults = verify(dataset.path)
    assert len(faults) == 1
    assert f"frames/000009/{name}: " in faults[0]


def test_verify_finds_nothing_in_a_good_data_set(dataset_path):
    assert verify(dataset_path) == []


def test_verify_finds_all_faults_at_once(dataset_path):
    frames = dataset_path / "frames"
    shutil.rmtree(frames / "000003")
    (frames / "000005/extra.txt").write_text("x")
    (frames / "000007/wide.png").write_bytes(b"")
    (frames / "000099").mkdir()
    (frames / ".tmp-999999999-000003").mkdir()
    (dataset_path / "notes.txt").write_text("x")
    faults = "\n".join(verify(dataset_path))
    assert faults.count("\n") == 5
    for text in (
        "1 of 10 frames are missing (000003)",
        "000005/extra.txt: it does not belong to the frame",
        "000007/wide.png: its digest is e3b0c442",
        "000099: it does not belong to the data set",
        "a killed run left it half-written",
        "notes.txt: it does not belong to the data set",
    ):
        assert text in faults


def test_verify_compares_the_table_with_the_frames(dataset_path):
    """An edit that also mends frame.json's own digest is found by the table, with both values."""
    file = dataset_path / "frames/000009/frame.json"
    body = json.loads(file.read_text())
    body.pop("digest")
    body["sensors"]["wide"]["sensor_from_target"]["tz_m"] = 108.0
    file.write_text(readable_json(body | {"digest": sha256_of_json(body)}))
    (fault,) = verify(dataset_path)
    assert fault.endswith("frame 9, wide, tz_m: it states 109.0, frame.json states 108.0: it was edited")


def test_verify_reads_a_broken_table(dataset_path):
    table = dataset_path / "truth.parquet"
    table.write_bytes(table.read_bytes()[:-10])
    (fault,) = verify(dataset_path)
    assert "truth.parquet: it is truncated or edited" in fault
    table.unlink()
    (fault,) = verify(dataset_path)
    assert fault.endswith("truth.parquet: it is missing; --resume writes it")
