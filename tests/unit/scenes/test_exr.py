"""Layers through OpenEXR: every bit comes back, the same layers give the same bytes, empty space costs nothing."""

import io
import time

import numpy as np
import OpenEXR
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from scenes.exr import Window, decode, encode, occupied

SHAPE = (9, 14)


@settings(deadline=None, max_examples=60)
@given(
    arrays.arrays(np.uint32, SHAPE, elements=st.integers(0, 2**32 - 1), fill=st.just(0)),
    arrays.arrays(np.uint32, SHAPE, elements=st.integers(0, 2**32 - 1), fill=st.just(0)),
)
def test_every_bit_pattern_comes_back(bits, ids):
    """Floats of any bits: NaN with its payload, infinity, −0, denormals; ids up to 2³² − 1."""
    layers = {"direct_diffuse": bits.view(np.float32), "part_id": ids}
    back = decode(encode(layers, SHAPE[1], SHAPE[0]))
    assert back["direct_diffuse"].dtype == np.float32
    np.testing.assert_array_equal(back["direct_diffuse"].view(np.uint32), bits)
    np.testing.assert_array_equal(back["part_id"], ids)


@pytest.fixture
def layers():
    rng = np.random.default_rng(0)
    spot = np.zeros(SHAPE, np.float32)
    spot[2:5, 3:11] = rng.random((3, 8)) + 0.1
    return {"z_m": spot, "normal.x": spot - 2 * spot, "part_id": (spot > 0).astype(np.uint32)}


def test_a_window_is_the_picture_without_its_empty_part(layers):
    assert occupied(layers) == Window(3, 2, 8, 3)
    cut = {name: layer[2:5, 3:11] for name, layer in layers.items()}
    assert encode(cut, SHAPE[1], SHAPE[0], Window(3, 2, 8, 3)) == encode(layers, SHAPE[1], SHAPE[0])


def test_bytes_do_not_depend_on_order_or_memory_layout(layers):
    one = encode(layers, SHAPE[1], SHAPE[0])
    other = {name: np.asfortranarray(layers[name]) for name in reversed(layers)}
    assert encode(other, SHAPE[1], SHAPE[0]) == one
    assert set(layers) == {"z_m", "normal.x", "part_id"}  # the binding changes what it is given, we do not


def test_any_reader_of_the_format_finds_picture_and_window(layers):
    file = OpenEXR.File(io.BytesIO(encode(layers, SHAPE[1], SHAPE[0])), separate_channels=True)
    header = file.header()
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION
    assert [edge.tolist() for edge in header["displayWindow"]] == [[0, 0], [13, 8]]
    assert [edge.tolist() for edge in header["dataWindow"]] == [[3, 2], [10, 4]]
    np.testing.assert_array_equal(file.channels()["z_m"].pixels, layers["z_m"][2:5, 3:11])


def test_an_empty_picture_is_a_picture(layers):
    empty = {name: np.zeros_like(layer) for name, layer in layers.items()}
    back = decode(encode(empty, SHAPE[1], SHAPE[0]))
    assert all(layer.shape == SHAPE and not layer.any() for layer in back.values())


@pytest.mark.parametrize(
    ("change", "window", "text"),
    [
        ({"z_m": np.zeros(SHAPE)}, None, "dtype float64, not float32 or uint32"),
        ({"z_m": np.zeros(SHAPE, np.float16)}, None, "dtype float16"),
        ({"z_m": np.zeros((3, 3), np.float32)}, None, r"shape \(3, 3\), not \(9, 14\)"),
        ({}, Window(0, 0, 3, 3), r"shape \(9, 14\), not \(3, 3\)"),
        ({}, Window(10, 0, 5, 9), "outside the picture of 14 × 9 pixels"),
        ({}, Window(-1, 0, 5, 9), "outside the picture"),
    ],
)
def test_what_is_no_layer_is_refused(layers, change, window, text):
    with pytest.raises(ValueError, match=text):
        encode({**layers, **change}, SHAPE[1], SHAPE[0], window)


def test_no_layers_are_refused():
    with pytest.raises(ValueError, match="at least one layer"):
        encode({}, 3, 3)


@pytest.mark.parametrize("harm", [b"", b"hello" * 100, "cut"])
def test_a_broken_file_is_said_to_be_one(layers, harm):
    data = encode(layers, SHAPE[1], SHAPE[0])
    with pytest.raises(ValueError, match="not a readable EXR file"):
        decode(data[: len(data) // 2] if harm == "cut" else harm)


def test_empty_space_costs_nothing():
    """14 layers of a 1292 × 964 picture with a target of 512 × 96 pixels: a quarter of the time of the whole picture.

    A ratio, because the machine may be busy; measured by itself: 28 ms against 141 ms of CPU.
    """
    window, rng = Window(380, 430, 512, 96), np.random.default_rng(0)
    cut = {f"layer{number:02d}": rng.random((96, 512), dtype=np.float32) for number in range(14)}
    whole = {}
    for name, layer in cut.items():
        whole[name] = np.full((964, 1292), 1e-30, np.float32)
        whole[name][window.slices] = layer
    assert _cpu_s(lambda: encode(cut, 1292, 964, window)) < 0.5 * _cpu_s(lambda: encode(whole, 1292, 964))


def _cpu_s(work):
    times = []
    for _ in range(3):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)
