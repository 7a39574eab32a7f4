"""Engines in another Python: whatever their process does, the suite names it, and goes on."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from multibody_xval.engines.interface.presets import Option, Preset
from multibody_xval.engines.isolated.out_of_process import OutOfProcessLane
from multibody_xval.engines.isolated.process import WORKER, EngineProcess, EngineProcessError
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import lane_of, random_state

SERVER = Path(__file__).with_name("faulty_server.py")
ROOT = Path(__file__).parents[3]
LIMIT = 30.0
STILL = {"position": np.zeros(2), "velocity": np.ones(2), "loads": np.zeros(3), "record": True}


@pytest.fixture
def process() -> Iterator[EngineProcess]:
    started = EngineProcess("tested", sys.executable, SERVER)
    yield started
    started.close()


def run(process: EngineProcess, trouble: str, limit: float = LIMIT) -> dict[str, np.ndarray]:
    process.request("build", LIMIT, number=1, trouble=trouble)
    return process.request("run", limit, number=1, **STILL)


def goes_on(process: EngineProcess) -> bool:
    """Whether a run comes back as it was computed."""
    return np.array_equal(run(process, "none")["position"], [[1, 1], [2, 2], [3, 3]])


def lane_in(process: EngineProcess) -> OutOfProcessLane:
    options = {"units": Option("SI", "", ""), "trouble": Option("none", "", "")}
    return OutOfProcessLane(process, lane_of(), Preset("", options), "joint")


def ends(process: int) -> bool:
    """Whether a process that is no child of this one ends in ten seconds; a zombie has ended."""
    status, end = Path(f"/proc/{process}/stat"), time.monotonic() + 10
    while status.exists() and status.read_text().rsplit(")", 1)[1].split()[0] != "Z":
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def python(program: str) -> subprocess.Popen[str]:
    start = (
        "import os, sys; from pathlib import Path\n"
        "from multibody_xval.engines.isolated.process import EngineProcess\n"
        f"process = EngineProcess('tested', sys.executable, Path({str(SERVER)!r}))\n"
        "process.request('versions', 30.0); first = process._worker.process.pid\n"
    )
    command, pipe = [sys.executable, "-c", start + textwrap.dedent(program)], subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, env={**os.environ, "PYTHONPATH": str(ROOT)})


@pytest.mark.parametrize(
    ("trouble", "said"),
    [
        ("crash", r"signal 11 \(SIGSEGV\) during 'run', in string_at \(__init__.py:\d+\); .*about to read nowhere"),
        ("exit", "tested ended with code 3"),
        ("hang", r"finish 'run' within 2 s and was killed, in .* \(faulty_server"),
        ("garble", "sent something other than a reply"),
        ("half", "sent something other than a reply|ended with code 0"),
    ],
)
def test_what_ends_a_worker_is_named_and_the_next_use_starts_afresh(process, trouble: str, said: str) -> None:
    with pytest.raises(EngineProcessError, match=said):
        run(process, trouble, limit=2.0 if trouble == "hang" else LIMIT)
    assert goes_on(process)
    assert process.generation == 2


def test_an_exception_comes_with_its_traceback_and_the_worker_lives_on(process: EngineProcess) -> None:
    with pytest.raises(EngineProcessError, match="ArithmeticError: the solver lost its way") as caught:
        run(process, "raise")
    assert "faulty_server.py" in "".join(caught.value.__notes__)
    with pytest.raises(EngineProcessError, match="SystemExit: no licence"):
        run(process, "leave")
    assert goes_on(process)
    assert process.generation == 1


def test_what_an_engine_prints_disturbs_nothing(process, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(process, "print")["position"].shape == (3, 2)
    assert capfd.readouterr() == ("", "")


def test_the_worker_sees_nothing_of_this_environment(process, monkeypatch, tmp_path: Path) -> None:
    """Else a server called siconos.py, or a module next to the worker's, would hide the package."""
    for name in ("PYTHONPATH", "LD_LIBRARY_PATH"):
        monkeypatch.setenv(name, str(tmp_path))
    reply = {name: str(value) for name, value in process.request("versions", LIMIT).items()}
    assert not {str(tmp_path), str(SERVER.parent), str(WORKER.resolve().parent)} & set(reply["path"].split(os.pathsep))
    assert "LD_LIBRARY_PATH" not in reply["environment"]
    assert not {"multibody_xval", "reference_lcp", "scipy"} & set(reply["modules"].split())


@pytest.mark.slow
def test_an_interrupted_wait_does_not_mix_up_replies(process: EngineProcess) -> None:
    def interrupt(_number: int, _frame: object) -> None:
        raise KeyboardInterrupt

    previous = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 1.0)
    with pytest.raises(KeyboardInterrupt):
        run(process, "hang")
    signal.signal(signal.SIGALRM, previous)
    assert goes_on(process)


def test_threads_take_turns(process: EngineProcess) -> None:
    def end(state: State) -> State:
        model = lane_in(process)
        return [model.advance(state, 0, 5) for _ in range(20)][-1]

    states = [random_state(size=0.1 * (k + 1)) for k in range(4)]
    with ThreadPoolExecutor(4) as threads:
        for state, moved in zip(states, threads.map(end, states), strict=True):
            assert moved.positions == pytest.approx(state.positions + 5 * state.velocities)


def test_a_worker_ends_with_its_parent_even_if_that_is_killed() -> None:
    with python("print(first, flush=True); sys.stdin.read()") as parent:
        assert parent.stdout is not None
        worker = int(parent.stdout.readline())
        parent.kill()
    assert ends(worker)


def test_a_forked_process_has_a_worker_of_its_own() -> None:
    parent = python("""
        fork = os.fork()
        process.request("versions", 30.0)
        if fork == 0:
            os._exit(process._worker.process.pid == first)
        sys.exit(os.waitpid(fork, 0)[1] or process._worker.process.pid != first)
    """)
    parent.communicate()
    assert parent.returncode == 0


def test_a_lane_is_built_again_where_its_worker_was_lost_or_it_was_closed(process: EngineProcess) -> None:
    model = lane_in(process)
    ends_at = [model.run(random_state(), 0, 5).positions]
    assert process._worker is not None
    worker = process._worker.process.pid
    os.kill(worker, signal.SIGKILL)
    assert ends(worker)
    ends_at.append(model.run(random_state(), 0, 5).positions)
    model.close()
    ends_at.append(model.run(random_state(), 0, 5).positions)
    assert np.array_equal(ends_at[0], ends_at[1])
    assert np.array_equal(ends_at[0], ends_at[2])
    assert process.generation == 2
