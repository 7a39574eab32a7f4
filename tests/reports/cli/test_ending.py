"""How commands end: by Ctrl-C within two seconds, by a reader that has enough, a full disk, or a fault of the suite."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from reference_lcp.environment import ONE_THREAD

END_SECONDS = 2.0
"""Within which a command has to end."""


def started(
    *arguments: str, path: Path | None = None, handler: signal.Handlers = signal.SIG_DFL
) -> subprocess.Popen[str]:
    """Start Python; gives it once it has printed that it is ready. A background job's Ctrl-C would be ignored."""
    own = subprocess.Popen(
        [sys.executable, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ if path is None else {**os.environ, "PYTHONPATH": str(path)},
        preexec_fn=lambda: signal.signal(signal.SIGINT, handler),  # noqa: PLW1509 - this process has no threads
    )  # fmt: skip
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
    "command", ["-m multibody_xval engines", f"{Path(sys.executable).with_name('multibody-xval')}"]
)
def test_command_that_is_importing_ends_without_a_traceback(tmp_path, command) -> None:
    (tmp_path / "typer.py").write_text("import time\nprint('ready', flush=True)\ntime.sleep(1000)\n")
    assert interrupted(started(*command.split(), path=tmp_path)) == (130, "error: interrupted\n")


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


def test_command_that_does_not_close_ends_after_a_moment_and_by_a_second_interrupt_at_once() -> None:
    """And one that a module turns into an error of its own is an interrupt."""
    assert interrupted(started("-c", COMMAND, "closes", "1")) == (130, "")
    assert interrupted(started("-c", COMMAND, "swallows", "1000")) == (130, "error: interrupted\n")
    own = started("-c", COMMAND, "closes", "1000")
    own.send_signal(signal.SIGINT)
    assert own.stdout.readline() == "closing\n"
    assert interrupted(own) == (130, "")


ENDING = """
import atexit, time
from multibody_xval.reports.cli import ending, entry_point
ending.run_command = lambda app: 0
atexit.register(lambda: (print("ready", flush=True), time.sleep(1000)))
entry_point.main()
"""


def test_interrupt_of_a_command_that_is_done_ends_it_without_a_word() -> None:
    """As Python ends, which takes a third of a second, it prints exceptions and forgets them: the code would be 0."""
    assert interrupted(started("-c", ENDING)) == (130, "")


@pytest.mark.slow
def test_background_job_that_ignores_interrupts_goes_on_ignoring_them() -> None:
    own = started("-c", COMMAND, "closes", "1", handler=signal.SIG_IGN)
    own.send_signal(signal.SIGINT)
    with pytest.raises(subprocess.TimeoutExpired):
        own.wait(END_SECONDS)
    own.kill()
    own.communicate()


MULTIPLY = """
import os, typer
from multibody_xval.reports.cli.ending import run_command
app = typer.Typer()
@app.command()
def multiply():
    import numpy as np
    np.ones((500, 500)) @ np.ones((500, 500))
    print(len(os.listdir("/proc/self/task")))
run_command(app, [])
"""


@pytest.mark.skipif(not Path("/proc/self/task").exists() or (os.cpu_count() or 1) < 2, reason="threads are not seen")
def test_linear_algebra_of_a_command_has_one_thread() -> None:
    """What a command times is the work of one core, and does not wait for other programs on the others."""
    free = {name: value for name, value in os.environ.items() if name not in ONE_THREAD}
    assert subprocess.check_output([sys.executable, "-c", MULTIPLY], env=free) == b"1\n"


def test_a_reader_that_has_enough_ends_a_command_silently_and_a_full_disk_with_a_line() -> None:
    def written_to(output: int) -> tuple[int, str]:
        words = [sys.executable, "-m", "multibody_xval", "--help"]
        done = subprocess.run(words, stdout=output, stderr=subprocess.PIPE, text=True, check=False)
        return done.returncode, done.stderr

    reader, writer = os.pipe()
    os.close(reader)
    assert written_to(writer) == (ExitCode.READER_GONE, "")
    os.close(writer)
    full = "error: standard output cannot be written: No space left on device\n"
    with Path("/dev/full").open("w") as disk:
        assert written_to(disk.fileno()) == (ExitCode.RUN_FAILED, full)


class Panic(BaseException):
    """As engines in Rust raise it: no `Exception`."""


@pytest.mark.parametrize("kind", [ZeroDivisionError, Panic, SystemExit])
def test_a_fault_of_the_suite_has_a_code_of_its_own_one_line_and_its_details(monkeypatch, capsys, kind) -> None:
    def faulty(_name: str) -> None:
        raise kind("a\nfault\x1b[2J")

    monkeypatch.setattr("multibody_xval.engines.interface.registry.broken_reason", faulty)
    assert run_command(app, ["engines"]) == ExitCode.UNEXPECTED
    line = rf"error: a fault of the suite, {kind.__name__}: a fault\\x1b\[2J; details, .*: (\S+)\n"
    details = Path(re.fullmatch(line, capsys.readouterr().err)[1])
    assert "in faulty" in details.read_text()
    details.unlink()
