"""Errors are sentences with an exit status, and survive the way from a worker process."""

import pickle

import pytest

from scenes import errors
from scenes.errors import ConfigError, HardlightError, nearest, unknown


def test_the_nearest_name_is_suggested():
    names = ["zhai2014-in-plane", "zhai2014-out-of-plane", "sun"]
    assert nearest("zhai2014-inplane", names) == "; did you mean 'zhai2014-in-plane'?"
    assert nearest("SUN", names) == "; did you mean 'sun'?"
    assert nearest("halogen", names) == ""
    assert unknown("light", "son", ["sun", "lamp"]) == "no light is called 'son'; did you mean 'sun'? (there are: lamp, sun)"
    assert unknown("study", "x", []) == "no study is called 'x' (there are: none)"


@pytest.mark.parametrize(
    "kind", [kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, HardlightError)]
)
def test_every_error_comes_back_from_another_process(kind):
    error = kind(["one", "two"]) if kind is ConfigError else kind("one sentence")
    back = pickle.loads(pickle.dumps(error))
    assert type(back) is kind
    assert str(back) == str(error)
    assert back.exit_status in (1, 2)
    if kind is ConfigError:
        assert back.faults == ("one", "two")
