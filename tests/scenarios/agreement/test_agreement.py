"""Agreement by pytest: a line a check, red for a wrong engine and one that crashes, one line for bad input."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "test_in_ci.md").read_text(encoding="utf-8")
ALONE = "-m pytest -p no:cacheprovider -p no:xdist -p no:hypothesispytest -o addopts="
COMMAND = f"{ALONE} --pyargs multibody_xval.agreement --xval-engine "


def run(arguments: str, folder: Path, code: int = 0) -> str:
    """Run Python in a folder; gives all that it prints."""
    command = [sys.executable, *arguments.split()]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


def test_lines_have_the_numbers_of_the_page_and_default_options_pass_unless_that_is_too_much(tmp_path: Path) -> None:
    printed = run(f"{COMMAND} mujoco:joint:tuned --xval-engine mujoco:joint:default --xval-allow 0.5", tmp_path, 1)
    lines = printed.splitlines()
    off = "mujoco joint default, friction 0.1, frequency 1.6: −6.059 dB, exact −20.793, off by 15 dB"
    assert f"FAILED {off}, allowed 0.5 dB" in lines
    tuned = [line for line in lines if line.startswith("mujoco joint tuned, ")]
    assert len(tuned) == 10
    shown = [line for line in PAGE.splitlines() if re.match("mujoco joint (tuned|default), ", line)]
    assert shown[0].startswith(tuned[0].partition(", allowed")[0])
    assert f"{off}; measured" in shown
    assert shown[2] in lines
    assert not re.search("FAILED mujoco joint tuned", printed)


def test_measured_presets_pass(tmp_path: Path) -> None:
    printed = run(f"{COMMAND} mujoco:contact:default", tmp_path)
    assert "no periodic steady state; measured" in printed
    assert re.search("block held at 0.9 of its friction: drift [89],[0-9]{3} µm/s; measured", printed)


def test_a_bound_that_is_off_by_a_hundredth_is_found_and_a_sound_copy_agrees(install) -> None:
    site = install("faulty")
    bound = site.run(*COMMAND.split(), "wrong-bound:joint:tuned", code=1)
    found = [line for line in bound.splitlines() if line.startswith("FAILED wrong-bound joint tuned, friction ")]
    assert len(found) == 6
    assert all(re.search(r"off by [\d.]+ dB, allowed", line) for line in found)
    assert "FAILED" not in site.run(*COMMAND.split(), "wrong-sound:joint:tuned")


def test_an_engine_that_crashes_gives_a_line_a_check(install) -> None:
    printed = install("faulty").run(*COMMAND.split(), "faulty-crash", code=1)
    lines = [line for line in printed.splitlines() if line.startswith("FAILED faulty-crash joint tuned, ")]
    assert len(lines) == 10
    assert all("failed: its process has ended by signal" in line for line in lines)


BAD = {
    "mujocco": "engine = 'mujocco' is unknown",
    "mujoco:hinge": "formulation of mujoco = 'hinge' is unknown",
    "pinocchio:contact:tuned": "formulation of pinocchio = 'contact' is unknown",
    "mujoco:joint:tunned": "preset of mujoco = 'tunned' is unknown",
    "mujoco:joint:tuned:1": "has 4 parts",
    "broken-module": "'broken-module' cannot be used: ModuleNotFoundError",
    "broken-exit": "'broken-exit' cannot be used: SystemExit",
    "mujoco --xval-allow abc": "--xval-allow = abc; allowed: > 0",
    "mujoco --xval-allow 0": "--xval-allow = 0; allowed: > 0",
    "mujoco --xval-allow nan": "--xval-allow = nan; allowed: > 0",
}


@pytest.mark.parametrize("module", ["multibody_xval.agreement", "multibody_xval.engines.contract"])
def test_bad_input_is_one_line_and_exit_code_4(install, module: str) -> None:
    """All in one process: what they import takes longer than what they do."""
    script = (
        "import contextlib, io, pytest\n"
        f"for arguments, problem in {BAD!r}.items():\n"
        "    said = io.StringIO()\n"
        "    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(said):\n"
        f"        code = pytest.main(['-o', 'addopts=', '--pyargs', '{module}', '--xval-engine', *arguments.split()])\n"
        "    lines = said.getvalue().strip().splitlines()\n"
        "    assert (code, len(lines)) == (4, 1), (arguments, code, lines)\n"
        "    assert lines[0].startswith('ERROR: --xval-') and problem in lines[0], lines\n"
    )
    install("broken").run("-c", script)


def test_sessions_of_others_lose_less_than_20_ms(tmp_path: Path) -> None:
    """Of a processor, the least of three: other programs run beside it."""
    script = (
        "import time, pytest, importlib.metadata\n"
        "begin = time.process_time()\n"
        "import multibody_xval.engines.contract.plugin, multibody_xval.scenarios.agreement.plugin\n"
        "print(time.process_time() - begin)\n"
    )
    (tmp_path / "cost.py").write_text(script)
    assert min(float(run("cost.py", tmp_path)) for _ in range(3)) < 0.02


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
    printed = run(f"{ALONE} -q -rpf", tmp_path, 1)
    ended = re.findall(r"^(PASSED|FAILED) test_(\d)", printed, flags=re.MULTILINE)
    assert sorted(ended, key=lambda own: own[1]) == [
        ("FAILED" if number else "PASSED", str(number)) for number in range(len(SPOILT)) for _ in range(3)
    ]
