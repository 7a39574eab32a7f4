"""An engine that always fails is named in the last lines of a scenario."""

import pytest


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "reason"), [("raises", "RuntimeError: no solution"), ("nan", "the engine's position")]
)
def test_an_engine_that_always_fails_fails_the_run_and_is_named_in_the_last_lines(install, name, reason) -> None:
    command = ["-m", "multibody_xval", "run", "unit-cell", "--workers", "1", "--engine", f"faulty-{name}"]
    *_, named, _, failing = install("mutations").run(*command, code=1).splitlines()
    assert named.startswith(f"unit-cell: faulty-{name} fails at 9 numbers of friction 0.6, η_r 0.9: {reason}")
    assert failing.startswith(f"unit-cell: faulty-{name}: 36 of 36 numbers")
