"""Agreement by pytest: a line a check, red for a wrong engine and one that crashes, one line for bad input."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from reference_lcp.errors import ParameterError

PAGE = (Path(__file__).parents[3] / "docs" / "how_to" / "test_in_ci.md").read_text(encoding="utf-8")
ALONE = "-m pytest -p no:cacheprovider -p no:xdist -p no:hypothesispytest -o addopts="
COMMAND = f"{ALONE} --pyargs multibody_xval.agreement"


def asked(*names: str) -> list[str]:
    return [*COMMAND.split(), *(word for name in names for word in ("--xval-engine", name))]


def test_every_check_prints_its_number_and_what_is_wrong_fails(install) -> None:
    """With the numbers of the page, in one session: measured presets and a sound copy pass, a wrong bound is found."""
    mujoco = ("mujoco:joint:tuned", "mujoco:joint:default", "mujoco:contact:default")
    copies = [f"faulty-{name}:joint:tuned" for name in ("sound", "bound", "dies")]
    lines = install("faulty").run(*asked(*mujoco, *copies), code=1).splitlines()
    checks = [re.match(r"((?:mujoco|faulty-\w+) \w+ \w+), ", line) for line in lines]
    count = {name: sum(bool(own) and own[1] == name for own in checks) for name in {own[1] for own in checks if own}}
    assert count["faulty-sound joint tuned"] == count["mujoco joint tuned"] == 10
    assert count["mujoco joint default"] == 11
    tuned, *default = (line for line in PAGE.splitlines() if re.match("mujoco joint (tuned|default), ", line))
    assert any(line.startswith(tuned.partition(", allowed")[0]) for line in lines), (
        "what is allowed depends on residuals"
    )
    assert len(default) == 2
    assert set(default) <= set(lines)
    assert "mujoco contact default, friction 0.1, frequency 1.4: no periodic steady state; measured" in lines
    failed = [line.removeprefix("FAILED ") for line in lines if re.match("FAILED (mujoco|faulty)", line)]
    found = [line for line in failed if line.startswith("faulty-bound joint tuned, ")]
    crashed = [line for line in failed if line.startswith("faulty-dies joint tuned, ") and "by signal SIGSEGV" in line]
    assert (len(found), len(crashed), len(failed)) == (7, 10, 17), failed
    differ = r", friction .*level and phase differ by [\d.e-]+ dB, allowed"
    assert sum(bool(re.search(differ, line)) for line in found) == 6


def test_default_options_fail_where_their_error_is_more_than_is_allowed(install) -> None:
    words = [*asked("mujoco:joint:default"), "-k", "1.6", "--xval-allow", "5"]
    lines = install("faulty").run(*words, code=1).splitlines()
    off = "mujoco joint default, friction 0.1, frequency 1.6: −6.059 dB, exact −20.793, off by 15 dB"
    assert f"FAILED {off}, allowed 5 dB" in lines


BAD = {
    "mujocko": "engine = 'mujocko' is unknown",
    "pinocchio:contact:tuned": "formulation of pinocchio = 'contact' is unknown",
    "mujoco:joint:tunned": "preset of mujoco = 'tunned' is unknown",
    "broken-import": "'broken-import' cannot be used: ModuleNotFoundError",
    "mujoco --xval-allow abc": "--xval-allow = abc; allowed: > 0",
    "mujoco --xval-allow nan": "--xval-allow = nan; allowed: > 0",
}


def test_bad_input_is_one_line_and_exit_code_4(install) -> None:
    """All in one process: what they import takes longer than what they do."""
    script = (
        "import contextlib, io, itertools, pytest\n"
        "modules = 'multibody_xval.agreement', 'multibody_xval.engines.contract'\n"
        f"for module, (arguments, problem) in itertools.product(modules, {BAD!r}.items()):\n"
        "    said = io.StringIO()\n"
        "    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(said):\n"
        "        code = pytest.main(['-o', 'addopts=', '--pyargs', module, '--xval-engine', *arguments.split()])\n"
        "    lines = said.getvalue().strip().splitlines()\n"
        "    assert (code, len(lines)) == (4, 1), (arguments, code, lines)\n"
        "    assert lines[0].startswith('ERROR: --xval-') and problem in lines[0], lines\n"
    )
    install("broken").run("-c", script)


OPTIONS = "    options = f'"
SPOILT = {
    "as it is": ("", ""),
    "default options": (OPTIONS, "    options = '' or f'' and f'"),
    "a bound off by 3 %": ('frictionloss="{1.friction_bound[0]}"', 'frictionloss="{3}"'),
    "a mass off by 1 %": ('mass="{1.inner_mass[0]}"', 'mass="{4}"'),
}
NUMBERS = "options, 1.03 * exact.chain.friction_bound[0], 1.01 * exact.chain.inner_mass[0])"


def test_example_of_a_test_of_ones_own_is_green_and_red_with_a_spoilt_simulation(tmp_path: Path) -> None:
    example = "\n\n".join(re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL))
    for number, (old, new) in enumerate(SPOILT.values()):
        assert old in example
        spoilt = example.replace(old, new).replace("options)", NUMBERS)
        (tmp_path / f"test_{number}.py").write_text(spoilt, encoding="utf-8")
    command = [sys.executable, *ALONE.split(), "-q", "-rpf"]
    printed = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False).stdout
    ended = re.findall(r"^(PASSED|FAILED) test_(\d)", printed, flags=re.MULTILINE)
    assert sorted(ended, key=lambda own: own[1]) == [
        ("FAILED" if number else "PASSED", str(number)) for number in range(len(SPOILT)) for _ in range(3)
    ]


def test_positions_of_a_run_that_repeats_are_a_steady_state_and_others_fail_with_their_number(
    exact_motion, steady_state_of
) -> None:
    exact = exact_motion(friction_ratio=0.6, mass_ratio=2.0)
    two_periods = np.tile(exact.positions, (2, 1))
    own = steady_state_of(two_periods, exact)
    assert (own.transmittance_db, own.phase_deg) == pytest.approx((exact.transmittance_db, exact.phase_deg), abs=1e-3)
    drifts = two_periods + 1e-6 * np.arange(len(two_periods))[:, None]
    with pytest.raises(pytest.fail.Exception, match=r"differ by 0\.04 of the base's amplitude; allowed: 1e-06"):
        steady_state_of(drifts, exact)
    with pytest.raises(ParameterError, match=r"allowed: \(800 or more, 2\)"):
        steady_state_of(exact.positions, exact)


MISUSED = {
    "lambda positions, velocities: (positions, velocities)": "simulation takes 2 arguments, .*; it is called with 3",
    "lambda positions, velocities, force: None": "the step gives None; allowed: positions, velocities",
    "lambda positions, velocities, force: (positions[:1], velocities)": "allowed: 2 finite numbers",
    "lambda positions, velocities, force: 1 / 0": "ZeroDivisionError: division by zero",
}


def test_a_wrong_use_of_the_fixtures_is_a_few_lines_of_the_test_itself(tmp_path: Path) -> None:
    tests = [
        f"def test_{number}(exact_motion, steady_state_of):\n    steady_state_of({step}, exact_motion())\n"
        for number, step in enumerate(MISUSED)
    ]
    tests.append("def test_ratio(exact_motion):\n    exact_motion(friction_ratio=-1)\n")
    (tmp_path / "test_misused.py").write_text("\n\n".join(tests), encoding="utf-8")
    command = [sys.executable, *ALONE.split(), "-q"]
    printed = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False).stdout
    for said in (*MISUSED.values(), "friction_ratio = -1"):
        assert re.search(rf"^E .*{said}", printed, flags=re.MULTILINE), printed
    assert f"{len(tests)} failed" in printed
    assert not re.search(r"^\S*(multibody_xval|reference_lcp|scenarios)/\S+:\d+", printed, flags=re.MULTILINE), printed
    assert len(printed.splitlines()) < 20 * len(tests)
