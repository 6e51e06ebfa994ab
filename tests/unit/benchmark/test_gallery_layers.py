"""The layers' colours decode to what the truth says, also where a layer is made smaller."""

import base64

import cv2
import numpy as np
import pytest

from benchmark.gallery_layers import SKY, Layer, bgr, layers
from benchmark.gallery_window import Window
from benchmark.report_ring_pictures import LIGHT_STATES

WHOLE = Window(0, 0, 40, 30)


def _pixels(layer: Layer) -> np.ndarray:
    kind, data = layer.uri.split(",")
    assert kind == "data:image/webp;base64"
    picture = cv2.imdecode(np.frombuffer(base64.b64decode(data), np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    return picture


def _truth(size: tuple[int, int] = (30, 40)) -> dict[str, np.ndarray]:
    """A ball that lights and shadows part; depth 5 m at its middle; the sky is 0 everywhere."""
    down, across = np.mgrid[0 : size[0], 0 : size[1]]
    x, y = (across - size[1] / 2) / (size[0] / 2.2), (down - size[0] / 2) / (size[0] / 2.2)
    there = x**2 + y**2 < 1
    z = -np.sqrt(np.clip(1 - x**2 - y**2, 0, 1))
    mask = np.where(there, np.where(x < 0, 1, 2), 0) | np.where(there & (x < -0.5), 16, 0)
    light = np.where(there, 10.0 ** (2 * x), 0)
    normal = {f"normal.{axis}": np.where(there, n, 0).astype(np.float32) for axis, n in zip("xyz", (x, y, z))}
    radiance = {"direct_diffuse": light, "direct_specular": 0 * light, "indirect": 0 * light}
    return {
        "mask": mask.astype(np.uint32), "z_m": np.where(there, 6 + z, 0).astype(np.float32),
        **normal, **{name: one.astype(np.float32) for name, one in radiance.items()},
    }  # fmt: skip


def test_light_states_decode_to_the_mask() -> None:
    truth = _truth()
    light = next(one for one in layers(truth, WHOLE) if one.key == "light")
    picture = _pixels(light)
    code = np.zeros(picture.shape[:2], dtype=int)
    for _, bit, colour in LIGHT_STATES:
        code[(picture == bgr(colour)).all(axis=-1)] = bit
    seen = [next(bit for _, bit, _ in reversed(LIGHT_STATES) if value & bit) if value else 0 for value in truth["mask"].ravel()]
    np.testing.assert_array_equal(code.ravel(), seen)
    assert ((picture == bgr(SKY)).all(axis=-1) == (truth["mask"] == 0)).all()
    assert {name for _, name in light.swatches} == {name for name, _, _ in LIGHT_STATES}


def test_normals_decode_to_their_directions() -> None:
    truth = _truth((300, 300))
    normals = next(one for one in layers(truth, Window(0, 0, 300, 300)) if one.key == "normals")
    picture = _pixels(normals).astype(float) / 255
    there = truth["mask"] > 0
    decoded = np.stack([2 * picture[..., 2] - 1, 1 - 2 * picture[..., 1], 1 - 2 * picture[..., 0]], axis=-1)
    true = np.stack([truth[f"normal.{axis}"] for axis in "xyz"], axis=-1)
    assert np.median(np.abs(decoded - true)[there]) < 0.03  # WebP loses a little


def test_radiance_is_logarithmic_and_depth_says_its_range() -> None:
    found = {one.key: one for one in layers(_truth(), WHOLE)}
    assert list(found) == ["radiance", "light", "depth", "normals"]
    low, high = float(found["depth"].low.split()[0]), float(found["depth"].high.split()[0])
    assert low == pytest.approx(5.0, abs=0.02)
    assert high == pytest.approx(6.0, abs=0.2)
    assert found["depth"].low.endswith(" m")
    assert len(found["depth"].scale) > 2
    brightness = _pixels(found["radiance"]).sum(axis=-1).astype(float)[15, 8:32:4]
    steps = np.diff(brightness)
    assert (steps > 0).all()  # a hundredfold from left to right, in even steps
    assert steps.max() < 4 * steps.min()


def test_a_wide_cut_out_is_thinned_to_whole_pixels_where_they_are() -> None:
    mask = np.zeros((500, 1000), dtype=np.uint32)
    mask[:, 500:] = 2
    mask[:, 250:500] = 1
    (light,) = layers({"mask": mask}, Window(0, 0, 1000, 500))
    picture = _pixels(light)
    assert picture.shape == (180, 360, 3)
    colours = {name: bgr(colour) for name, _, colour in LIGHT_STATES}
    assert {tuple(one) for one in picture.reshape(-1, 3).tolist()} == {bgr(SKY), colours["lit"], colours["attached shadow"]}
    edges = np.flatnonzero(np.any(np.diff(picture[0].astype(int), axis=0), axis=1)) + 1
    assert np.abs(edges / 360 - [0.25, 0.5]).max() < 1 / 360


def test_layers_that_are_not_there_or_dark_are_left_out() -> None:
    empty = {name: np.zeros_like(layer) for name, layer in _truth().items()}
    assert [one.key for one in layers(empty, WHOLE)] == ["light", "normals"]
    assert list(layers({}, WHOLE)) == []
