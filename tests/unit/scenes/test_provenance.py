"""One text for one value, one stream for one field of one frame."""

import json
import math
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes.provenance import canonical_json, readable_json, sha256_of_bytes, sha256_of_json, software_versions, stream

PINNED = [0.7119174156890491, 0.7559271837120507]  # what stream(7, 123, "motion.attitude") began with when format 1 was made
FINITE = st.floats(allow_nan=False, allow_infinity=False)
PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | FINITE | st.text(st.characters(exclude_categories=["Cs"])),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.text(st.characters(exclude_categories=["Cs"]), max_size=5), inner, max_size=4)
    ),
    max_leaves=12,
)


@given(PLAIN)
def test_json_comes_back_exactly(value):
    for text in (canonical_json(value), readable_json(value)):
        assert json.loads(text) == value
    assert canonical_json(json.loads(canonical_json(value))) == canonical_json(value)


@given(FINITE)
def test_floats_are_the_shortest_text_that_comes_back(number):
    text = canonical_json(number)
    assert float(text) == number
    assert math.copysign(1, float(text)) == math.copysign(1, number)
    digits = len(text.lstrip("-").partition("e")[0].replace(".", "").strip("0"))
    assert digits <= 1 or float(f"{number:.{digits - 2}e}") != number


@given(st.dictionaries(st.text(max_size=3), st.integers(), min_size=2, max_size=5))
def test_the_order_of_keys_does_not_matter(table):
    backward = dict(reversed(table.items()))
    assert sha256_of_json(table) == sha256_of_json(backward)


def test_canonical_text():
    value = {"b": [1, 2.5, True, None], "a": np.float64(0.1), "c": np.arange(2), "ä": ("x", np.int64(3))}
    assert canonical_json(value) == '{"a":0.1,"b":[1,2.5,true,null],"c":[0,1],"ä":["x",3]}'
    assert sha256_of_json({}) == sha256_of_bytes(b"{}") == "44136fa355b3678a1146ad16f7e8649e94fb4fc21fe77e8310c060f61caaff8a"


@pytest.mark.parametrize("wrong", [math.nan, math.inf, [1.0, -math.inf], {"a": np.float32("nan")}, np.array([np.nan])])
def test_what_json_has_not_is_refused(wrong):
    for to_text in (canonical_json, readable_json):
        with pytest.raises(ValueError, match="not JSON compliant"):
            to_text(wrong)


@pytest.mark.parametrize("wrong", [{1: 2}, {None: 1}, object(), {1, 2}, 1j])
def test_what_has_no_plain_form_is_refused(wrong):
    with pytest.raises(TypeError):
        canonical_json(wrong)


def test_streams_are_a_function_of_seed_frame_and_path_in_every_process():
    """The value itself is a contract: a data set of last year draws the same."""
    here = stream(7, 123, "motion.attitude").random(3).tolist()
    program = "from scenes.provenance import stream; print(stream(7, 123, 'motion.attitude').random(3).tolist())"
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.strip() == str(here)
    assert here[:2] == PINNED


def test_seed_zero_is_a_seed():
    assert stream(0, 0, "").random() == stream(0, 0, "").random()
    assert stream(0, 0, "a").random() != stream(1, 0, "a").random()
    with pytest.raises(ValueError, match="non-negative"):
        stream(-1, 0, "a")


def test_neighbouring_streams_are_uncorrelated_and_uniform():
    """4000 streams that differ in frame or path: mean 1/2 and pairwise correlation 0 within five standard errors."""
    count = 2000
    by_frame = np.array([stream(1, frame, "lights.sun.direction").random() for frame in range(count)])
    by_path = np.array([stream(1, 5, f"field{number}").random() for number in range(count)])
    for values in (by_frame, by_path):
        assert abs(values.mean() - 0.5) < 5 / math.sqrt(12 * count)
        assert abs(np.corrcoef(values[:-1], values[1:])[0, 1]) < 5 / math.sqrt(count)
        assert len(np.unique(values)) == count
    assert abs(np.corrcoef(by_frame, by_path)[0, 1]) < 5 / math.sqrt(count)


def test_versions_are_known_without_importing_what_they_are_of():
    program = (
        "import sys; from scenes.provenance import software_versions; software_versions(); "
        "print({'mitsuba', 'drjit', 'cv2', 'OpenEXR', 'pyoidn', 'scipy', 'trimesh'} & sys.modules.keys())"
    )
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout == "set()\n"
    versions = software_versions()
    assert {"hardlight", "python", "numpy", "scipy", "mitsuba", "drjit", "opencv", "OpenEXR", "pyoidn"} <= versions.keys()
    assert versions["numpy"] == np.__version__
    assert versions["python"] == ".".join(map(str, sys.version_info[:3]))


def test_what_is_not_installed_is_absent(monkeypatch):
    from importlib import metadata

    def missing(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "version", missing)
    assert software_versions()["mitsuba"] == "absent"
