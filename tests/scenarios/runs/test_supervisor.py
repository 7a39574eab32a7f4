"""Whatever a worker does, no process that it has started outlives its supervisor or its client."""

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from multibody_xval.scenarios.runs.supervisor import PRINTED_BYTES
from tests.scenarios.runs.builders import ended, eventually, running

END_SECONDS = 5.0
"""Within which all have to end, on a machine that is busy."""

WORKERS = {
    "sleeps": "note(os.getpid()); time.sleep(1000)",
    "is stopped": "note(os.getpid()); os.kill(os.getpid(), signal.SIGSTOP)",
    "holds the lock of the interpreter": "note(os.getpid()); ctypes.PyDLL(None).sleep(1000)",
    "ignores signals": "[signal.signal(s, signal.SIG_IGN) for s in (1, 2, 15)]; note(os.getpid()); time.sleep(1000)",
    "leaves a daemon": """
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        note(os.getpid())
        time.sleep(1000)
    os._exit(0)
time.sleep(1000)""",
    "starts a program with its own session": """
note(subprocess.Popen(["sleep", "1000"], start_new_session=True).pid)
time.sleep(1000)""",
}
"""What workers do, by name; each notes the process that has to end."""

PROGRAM = """
import ctypes, os, signal, subprocess, sys, time
from pathlib import Path
from multibody_xval.scenarios.runs.supervisor import supervise
def note(process):
    part = Path(sys.argv[1] + ".part")
    part.write_text(str(process))
    part.rename(sys.argv[1])
supervise(int(sys.argv[2]))
"""


@contextlib.contextmanager
def started(folder: Path, worker: str, program: str = PROGRAM) -> Iterator[tuple[subprocess.Popen[bytes], int, int]]:
    """Start a supervisor with a worker; gives it, the lifeline, and the process that the worker has noted."""
    note, (released, lifeline) = folder / "process", os.pipe()
    command = [sys.executable, "-c", program + worker, str(note), str(released)]
    supervisor = subprocess.Popen(command, pass_fds=[released], start_new_session=True)
    os.close(released)
    try:
        assert eventually(note.exists, within=60)
        yield supervisor, lifeline, int(note.read_text())
    finally:
        with contextlib.suppress(OSError):
            os.close(lifeline)
        supervisor.kill()
        supervisor.wait()
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):
            os.kill(int(note.read_text()), 9)


def each_of(*names):
    """Parametrise a test by workers, the first of which it has by default: it waits for each of them."""
    slow = [pytest.param(name, marks=pytest.mark.slow) for name in names[1:]]
    return pytest.mark.parametrize("name", [names[0], *slow])


@each_of(*WORKERS)
def test_all_processes_end_when_the_client_lets_go(tmp_path, name) -> None:
    with started(tmp_path, WORKERS[name]) as (supervisor, lifeline, process):
        assert running(process)
        os.close(lifeline)
        assert ended([process], END_SECONDS)
        supervisor.wait(END_SECONDS)


@each_of("leaves a daemon", "starts a program with its own session")
def test_what_a_killed_worker_leaves_behind_ends(tmp_path, name) -> None:
    noted = "\nwhile not os.path.exists(sys.argv[1]): time.sleep(0.01)\nos.kill(os.getpid(), 9)"
    with started(tmp_path, WORKERS[name].removesuffix("time.sleep(1000)") + noted) as (supervisor, _, process):
        supervisor.wait(END_SECONDS)
        assert not running(process)


@each_of("sleeps", "is stopped", "holds the lock of the interpreter")
def test_worker_ends_with_a_supervisor_that_is_killed(tmp_path, name) -> None:
    with started(tmp_path, WORKERS[name]) as (supervisor, _, process):
        supervisor.kill()
        assert ended([process], END_SECONDS)


def test_daemon_outlives_a_worker_without_supervisor(tmp_path) -> None:
    """Broken twin: the process group of the worker is killed, and nothing else."""
    without = PROGRAM.replace("supervise(int", "(lambda *_: None)(int")
    with started(tmp_path, WORKERS["leaves a daemon"], without) as (supervisor, lifeline, process):
        os.close(lifeline)
        os.killpg(supervisor.pid, 9)
        supervisor.wait()
        assert running(process)


def test_flood_is_shown_up_to_its_limit_and_counted(tmp_path) -> None:
    read, lifeline = os.pipe()
    flood = "[os.write(1, 50_000 * b'~') for _ in range(100)]"
    command = [sys.executable, "-c", PROGRAM + flood, str(tmp_path / "none"), str(read)]
    done = subprocess.run(command, pass_fds=[read], stderr=subprocess.PIPE, check=True, timeout=60)
    os.close(read)
    os.close(lifeline)
    assert done.stderr.count(b"~") == PRINTED_BYTES
    assert done.stderr.decode().endswith(f"… ({5_000_000 - PRINTED_BYTES} bytes more)\n")
