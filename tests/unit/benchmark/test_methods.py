"""Methods are described without being imported, broken ones too."""

import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest

from benchmark import methods
from estimators import registry


@pytest.mark.parametrize("name", registry.names())
def test_our_methods_have_a_line_and_a_version(name: str) -> None:
    line = methods.description(name)
    assert len(line.split()) > 5
    assert "\n" not in line
    assert methods.version(name)


def test_listing_imports_no_method() -> None:
    code = (
        "import sys; from benchmark import listing; listing.listing('estimators');"
        "print([m for m in sys.modules if m.startswith('estimators.mono_rectangle.')])"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("value", "line"), [("nowhere.at_all:Class", "nowhere.at_all:Class"), ("json:JSONDecoder", "JSON (JavaScript Object Notation)")]
)
def test_a_method_that_does_not_import_is_named_by_where_it_should_be(
    value: str, line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    entry = EntryPoint("theirs", value, registry.GROUP)
    monkeypatch.setattr(methods, "entry_points", lambda group: [entry])
    assert methods.description("theirs").startswith(line)
    assert methods.version("theirs") == ""
    assert methods.description("others") == ""
