"""Ctrl-C ends every command within two seconds with one line and exit code 130, whatever the command is doing."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from reference_lcp.environment import ONE_THREAD

END_SECONDS = 2.0
"""Within which a command has to end."""

STILL_IMPORTING = "import time\nprint('ready', flush=True)\ntime.sleep(1000)\n"
"""A module that takes long to import."""


def started(*arguments: str, path: Path | None = None, ignored: bool = False) -> subprocess.Popen[str]:
    """Start Python; gives it once it has printed that it is ready. A background job's Ctrl-C would be ignored."""
    handler = signal.SIG_IGN if ignored else signal.SIG_DFL
    own = subprocess.Popen(
        [sys.executable, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ if path is None else {**os.environ, "PYTHONPATH": str(path)},
        preexec_fn=lambda: signal.signal(signal.SIGINT, handler),  # noqa: PLW1509 - this process has no threads
    )
    assert own.stdout.readline() == "ready\n"
    return own


def interrupted(process: subprocess.Popen[str]) -> tuple[int, str]:
    """Send Ctrl-C; gives exit code and standard error."""
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=60)
    assert time.monotonic() - begin < END_SECONDS
    return process.returncode, error


@pytest.mark.parametrize(
    "command",
    [
        ["-m", "multibody_xval", "engines"],
        ["-m", "multibody_xval"],
        ["-c", "from multibody_xval.reports.cli.entry_point import main; main()"],
    ],
    ids=["engines", "multibody_xval", "console script"],
)
def test_command_that_is_importing_ends_without_a_traceback(tmp_path, command) -> None:
    (tmp_path / "typer.py").write_text(STILL_IMPORTING)
    assert interrupted(started(*command, path=tmp_path)) == (130, "error: interrupted\n")


COMMAND = """
import sys, time
from multibody_xval.reports.cli import entry_point
entry_point.heed_interrupts()
entry_point.CLOSE_SECONDS = float(sys.argv[2])
import typer
from multibody_xval.reports.cli.ending import run_command
app = typer.Typer()
@app.command()
def command():
    try:
        print("ready", flush=True)
        time.sleep(1000)
    except KeyboardInterrupt:
        if sys.argv[1] == "swallows":
            raise ImportError("half imported") from None
        print("closing", flush=True)
        time.sleep(1000)
sys.exit(run_command(app, []))
"""


def test_command_that_does_not_close_ends_after_a_moment() -> None:
    assert interrupted(started("-c", COMMAND, "closes", "1")) == (130, "")


def test_second_interrupt_ends_at_once() -> None:
    own = started("-c", COMMAND, "closes", "1000")
    own.send_signal(signal.SIGINT)
    assert own.stdout.readline() == "closing\n"
    assert interrupted(own) == (130, "")


def test_interrupt_that_a_module_turns_into_its_own_error_is_one() -> None:
    assert interrupted(started("-c", COMMAND, "swallows", "1000")) == (130, "error: interrupted\n")


@pytest.mark.slow
def test_background_job_that_ignores_interrupts_goes_on_ignoring_them() -> None:
    own = started("-c", COMMAND, "closes", "1", ignored=True)
    own.send_signal(signal.SIGINT)
    with pytest.raises(subprocess.TimeoutExpired):
        own.wait(END_SECONDS)
    own.kill()
    own.communicate()


MULTIPLY = """
import os, sys, typer
from multibody_xval.reports.cli.ending import run_command
app = typer.Typer()
@app.command()
def multiply():
    import numpy as np
    np.ones((500, 500)) @ np.ones((500, 500))
    print(len(os.listdir("/proc/self/task")))
sys.exit(run_command(app, []) if sys.argv[1] == "command" else multiply())
"""


@pytest.mark.skipif(not Path("/proc/self/task").exists() or (os.cpu_count() or 1) < 2, reason="threads are not seen")
@pytest.mark.parametrize("how", ["command", "alone"])
def test_linear_algebra_of_a_command_has_one_thread_and_of_a_program_one_a_processor(how: str) -> None:
    """What a command times is the work of one core, and does not wait for other programs on the others."""
    free = {name: value for name, value in os.environ.items() if name not in ONE_THREAD}
    arguments = [sys.executable, "-c", MULTIPLY, how]
    done = subprocess.run(arguments, env=free, capture_output=True, text=True, check=True)
    assert (int(done.stdout) == 1) == (how == "command")
