"""An engine that always fails is named in the last lines of a scenario."""

import pytest


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "reason"), [("raises", "RuntimeError: no solution"), ("nan", "the engine's position")]
)
def test_an_engine_that_always_fails_fails_the_run_and_is_named_in_the_last_lines(install, name, reason) -> None:
    command = ["-m", "multibody_xval", "run", "unit-cell", "--workers", "1", "--engine", f"faulty-{name}"]
    printed = " ".join(install("faulty").run(*command, code=1).split())
    last = printed.rpartition("It fails: ")[2]
    assert last.startswith(f"faulty-{name}:joint:tuned: 20 of 20 numbers failed: {reason}")
