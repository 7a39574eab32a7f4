"""Ctrl-C ends every command within two seconds with one line and exit code 130, whatever the command is doing."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import typer

from reference_lcp import process

END_SECONDS = 2.0
"""Within which a command has to end."""

STILL_IMPORTING = "import time\nprint('ready', flush=True)\ntime.sleep(1000)\n"
"""A module that takes long to import."""


def started(*arguments: str, path: Path | None = None, ignored: bool = False) -> subprocess.Popen[str]:
    """Start Python; gives it once it has printed that it is ready. A background job's Ctrl-C would be ignored."""
    handler = signal.SIG_IGN if ignored else signal.SIG_DFL
    process = subprocess.Popen(
        [sys.executable, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ if path is None else {**os.environ, "PYTHONPATH": str(path)},
        preexec_fn=lambda: signal.signal(signal.SIGINT, handler),  # noqa: PLW1509 - this process has no threads
    )
    assert process.stdout.readline() == "ready\n"
    return process


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
        ["-m", "reference_lcp"],
        ["-m", "multibody_xval", "engines"],
        ["-m", "multibody_xval", "run"],
        ["-m", "multibody_xval"],
        ["-c", "from multibody_xval.reports.cli.entry_point import main; main()"],
    ],
    ids=["reference_lcp", "engines", "run", "multibody_xval", "console script"],
)
def test_command_that_is_importing_ends_without_a_traceback(tmp_path, command) -> None:
    (tmp_path / "typer.py").write_text(STILL_IMPORTING)
    assert interrupted(started(*command, path=tmp_path)) == (130, "error: interrupted\n")


CLOSING = """
import time
from reference_lcp.process import closing_on_interrupt, heed_interrupts
heed_interrupts()
with closing_on_interrupt():
    try:
        print("ready", flush=True)
        time.sleep(1000)
    except KeyboardInterrupt:
        print("closing", flush=True)
        time.sleep(1000)
"""


@pytest.mark.slow
def test_command_that_does_not_close_ends_after_a_moment() -> None:
    assert interrupted(started("-c", CLOSING)) == (130, "error: interrupted\n")


def test_second_interrupt_ends_at_once() -> None:
    patient = CLOSING.replace("\nwith", "\nimport reference_lcp.process as own\nown.CLOSE_SECONDS = 1000\nwith")
    process = started("-c", patient)
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "closing\n"
    assert interrupted(process) == (130, "error: interrupted\n")


SWALLOWED = """
import sys, time, typer
from reference_lcp.process import heed_interrupts
heed_interrupts()
from reference_lcp.process import run_command
app = typer.Typer()
@app.command()
def command():
    try:
        print("ready", flush=True)
        time.sleep(1000)
    except KeyboardInterrupt:
        raise ImportError("half imported") from None
sys.exit(run_command(app, []))
"""


def test_interrupt_that_a_module_turns_into_its_own_error_is_one() -> None:
    assert interrupted(started("-c", SWALLOWED)) == (130, "error: interrupted\n")


@pytest.mark.slow
def test_background_job_that_ignores_interrupts_goes_on_ignoring_them() -> None:
    process = started("-c", CLOSING, ignored=True)
    process.send_signal(signal.SIGINT)
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(END_SECONDS)
    process.kill()
    process.communicate()


@pytest.mark.parametrize("kept", [True, False])
def test_kernels_are_kept_in_a_private_folder_where_there_is_no_other_place(
    kept, tmp_path, monkeypatch, capsys
) -> None:
    """Below a file no folder can be made, whoever asks for it."""
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(process, "ROOT", tmp_path / "file")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / ("cache" if kept else "file")))
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setattr(process.tempfile, "tempdir", str(tmp_path))
    process.ensure_kernel_cache()
    line = capsys.readouterr().err
    assert ("NUMBA_CACHE_DIR" in os.environ) is not kept
    assert line.count("\n") == (not kept)
    if not kept:
        folder = Path(os.environ["NUMBA_CACHE_DIR"])
        assert folder.parent == tmp_path
        assert folder.stat().st_mode & 0o777 == 0o700
        code = "import numba\n\n@numba.njit(cache=True)\ndef f(x):\n    return x + 1\n\nprint(f(1))\n"
        (tmp_path / "own.py").write_text(code)
        done = subprocess.run([sys.executable, str(tmp_path / "own.py")], capture_output=True, text=True, check=True)
        assert done.stdout == "2\n"
        assert list(folder.rglob("*.nbi"))


@pytest.mark.parametrize(("home", "can"), [("/cache", False), ("/cache", True), ("cache", True)])
def test_kernels_are_kept_in_a_private_folder_where_no_absolute_place_can_be_written(
    home, can, monkeypatch, capsys
) -> None:
    kept, registered = home.startswith("/") and can, []
    monkeypatch.delenv(process.CACHE_VARIABLE, raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", home)
    monkeypatch.setattr(process, "_writable", lambda folder: can and "__pycache__" not in str(folder))
    monkeypatch.setattr(process.atexit, "register", registered.append)
    process.ensure_kernel_cache()
    assert (process.CACHE_VARIABLE not in os.environ) == kept
    assert ("compiled solvers are kept until the end only" in capsys.readouterr().err) != kept
    for remove in registered:
        remove()
    os.environ.pop(process.CACHE_VARIABLE, None)


def test_an_engine_that_ends_the_process_is_a_fault_and_no_completion(monkeypatch, capsys) -> None:
    app = typer.Typer()

    @app.command()
    def leave() -> None:
        raise SystemExit(0)

    monkeypatch.setattr(process, "_exit_code", lambda *_: leave())
    assert process.run_command(app, []) == process.ExitCode.UNEXPECTED
    assert "a fault of the suite, SystemExit" in capsys.readouterr().err


MULTIPLY = """
import os, sys, typer
from reference_lcp.process import run_command
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
    free = {name: value for name, value in os.environ.items() if name not in process.ONE_THREAD}
    arguments = [sys.executable, "-c", MULTIPLY, how]
    done = subprocess.run(arguments, env=free, capture_output=True, text=True, check=True)
    assert (int(done.stdout) == 1) == (how == "command")
