"""What is registered as an engine and is none: listed with the reason, refused where it is named, in nobody's way."""

import json
import os
import subprocess
import sys

import pytest

from multibody_xval.engines import engine_names
from multibody_xval.engines.interface.registry import default_engine_names

NO_TEXT = "'utf-8' codec can't encode character '\\udc80' in position {}: surrogates not allowed"

REASONS = {
    "broken-module": "ModuleNotFoundError: No module named 'no_such_module'",
    "broken-import": "ModuleNotFoundError: No module named 'no_such_package'",
    "broken-exit": "SystemExit: 0",
    "broken-attribute": "AttributeError: module 'broken_engines' has no attribute 'NotThere'",
    "broken-class": "TypeError: it is a NoEngine; allowed: a subclass of multibody_xval.Engine",
    "broken-function": "OSError: no licence server",
    "broken-abstract": "TypeError: Can't instantiate abstract class Unfinished",
    "broken-capabilities": "TypeError: its capabilities are a NoneType; allowed: Capabilities",
    "broken-version": "LookupError: no version of the wheel",
    "broken-number": "TypeError: its version() gives a int; allowed: a text",
    "broken-bytes": f"UnicodeEncodeError: {NO_TEXT.format(1)}",
    "broken-option": f"UnicodeEncodeError: {NO_TEXT.format(0)}",
    "broken-type": "TypeError: option iterations of its preset joint:tuned is a int; allowed: Option(value, default,",
    "broken-speech": "UnspeakableError: its message cannot be read (LookupError)",
    "broken-reason": "RuntimeError: no reason",
}


def test_broken_engines_are_rows_with_the_reason_and_the_others_are_as_before(install) -> None:
    rows = {
        row["engine"]: row for row in json.loads(install("broken").run("-m", "multibody_xval", "engines", "--json"))
    }
    assert set(rows) == {*engine_names(), *REASONS}
    for name, reason in REASONS.items():
        assert rows[name]["version"] is None
        assert rows[name]["missing"].startswith(reason)
    assert rows["reference"]["missing"] is None
    printed = install("broken").run("-m", "multibody_xval", "engines")
    assert "broken-function: OSError: no licence server" in printed


def test_broken_engines_take_no_part_where_none_is_named(install) -> None:
    script = "import json; from multibody_xval.engines.interface.registry import default_engine_names, engine_names; "
    printed = install("broken").run("-c", script + "print(json.dumps([engine_names(), default_engine_names()]))")
    given, default = json.loads(printed)
    assert (given, default) == (engine_names(), default_engine_names())


@pytest.mark.slow
@pytest.mark.parametrize("name", ["broken-import", "broken-exit", "broken-class", "broken-version"])
def test_broken_engine_that_is_named_is_one_line_and_exit_code_2(install, name) -> None:
    command = [sys.executable, "-m", "multibody_xval", "run", "unit-cell", "--engine", name]
    done = subprocess.run(command, env=install("broken").environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"error: engine = {name!r} cannot be used: {REASONS[name]}{os.linesep}"


@pytest.mark.slow
def test_run_of_another_engine_goes_on_beside_them(install, tmp_path) -> None:
    out = tmp_path / "out.csv"
    install("broken").run(
        "-m", "multibody_xval", "run", "unit-cell", "--engine", "reference:joint:tuned", "--out", str(out)
    )
    assert "agree" in out.read_text()
