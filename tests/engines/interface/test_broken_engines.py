"""What is registered as an engine and is none: listed with the reason, refused where it is named, in nobody's way."""

import json

import pytest

from multibody_xval.engines import engine_names

REASONS = {
    "broken-import": "ModuleNotFoundError: No module named 'no_such_package'",
    "broken-exit": "SystemExit: 0",
    "broken-class": "TypeError: it is a NoEngine; allowed: a subclass of multibody_xval.Engine",
    "broken-capabilities": "TypeError: its capabilities are a NoneType; allowed: Capabilities",
    "broken-version": "LookupError: no version of the wheel",
    "broken-type": "TypeError: option iterations of its preset joint:tuned is a int; allowed: Option(value, default,",
}


def test_broken_engines_are_rows_with_the_reason_and_the_others_are_as_before(install) -> None:
    printed = install("broken").run("-m", "multibody_xval", "engines", "--json")
    missing = {row["engine"]: row["missing"] for row in json.loads(printed)}
    assert set(missing) == {*engine_names(), *REASONS}
    assert missing["reference"] is None
    assert [name for name, reason in REASONS.items() if not missing[name].startswith(reason)] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["broken-import", "broken-exit", "broken-version"])
def test_broken_engine_that_is_named_is_one_line_and_exit_code_2(install, name) -> None:
    printed = install("broken").run("-m", "multibody_xval", "run", "unit-cell", "--engine", name, code=2)
    assert printed.strip() == f"error: engine = {name!r} cannot be used: {REASONS[name]}"


@pytest.mark.slow
def test_run_of_another_engine_goes_on_beside_them(install) -> None:
    install("broken").run("-m", "multibody_xval", "run", "unit-cell", "--engine", "reference")
