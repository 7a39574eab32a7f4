"""Engines in another Python: whatever their process does, the suite names it, and goes on."""

import io
import os
import pickle
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from multibody_xval.engines.interface.presets import Capabilities, FrictionLaw, Option, Preset
from multibody_xval.engines.isolated import out_of_process
from multibody_xval.engines.isolated.out_of_process import OutOfProcessEngine, OutOfProcessLane
from multibody_xval.engines.isolated.process import EngineProcess, EngineProcessError
from multibody_xval.engines.isolated.worker import NotAMessage, read_message, write_message
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
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


def lane_in(process: EngineProcess, trouble: str = "none") -> OutOfProcessLane:
    return OutOfProcessLane(
        process, lane_of(), Preset("", {"units": Option("SI", "", ""), "trouble": Option(trouble, "", "")}), "joint"
    )


def ends(process: int, within: float) -> bool:
    """Whether a process that is no child of this one ends in time; a zombie has ended."""
    until = time.monotonic() + within
    while time.monotonic() < until:
        status = Path(f"/proc/{process}/stat")
        if not status.exists() or status.read_text().rsplit(")", 1)[1].split()[0] == "Z":
            return True
        time.sleep(0.02)
    return False


def python(program: str) -> subprocess.Popen[str]:
    start = (
        "import os, sys; from pathlib import Path\n"
        "from multibody_xval.engines.isolated import process as out_of_process\n"
        f"process = out_of_process.EngineProcess('tested', sys.executable, Path({str(SERVER)!r}))\n"
    )
    return subprocess.Popen(
        [sys.executable, "-c", start + textwrap.dedent(program)],
        stdin=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        text=True,
    )


def test_a_run_comes_back_as_it_was_computed(process: EngineProcess) -> None:
    rows = run(process, "none")
    assert np.array_equal(rows["position"], [[1, 1], [2, 2], [3, 3]])
    assert rows["position"].dtype == np.float64


def test_only_the_end_is_sent_when_no_record_is_requested(process: EngineProcess) -> None:
    process.request("build", LIMIT, number=1, trouble="none")
    end = process.request("run", LIMIT, number=1, **{**STILL, "record": False})
    assert set(end) == {"position", "velocity"}
    assert np.array_equal(end["position"], [[3, 3]])


def test_a_segmentation_fault_is_named_and_the_next_use_starts_afresh(process: EngineProcess) -> None:
    with pytest.raises(
        EngineProcessError, match=r"signal 11 \(SIGSEGV\) during 'run', in string_at \(__init__.py:\d+\); .*nowhere"
    ):
        run(process, "crash")
    assert run(process, "none")["position"].shape == (3, 2)
    assert process.generation == 2


def test_what_was_printed_in_earlier_requests_is_not_quoted(process: EngineProcess) -> None:
    run(process, "print")
    process.request("build", LIMIT, number=1, trouble="crash")
    with pytest.raises(EngineProcessError, match=r"printed last: about to read nowhere$"):
        process.request("run", LIMIT, number=1, **STILL)


def test_an_engine_that_ends_by_itself_is_named(process: EngineProcess) -> None:
    with pytest.raises(EngineProcessError, match="tested ended with code 3"):
        run(process, "exit")


def test_a_hang_in_compiled_code_is_killed_at_its_limit(process: EngineProcess) -> None:
    start = time.monotonic()
    with pytest.raises(
        EngineProcessError, match=r"finish 'run' within 0\.5 s and was killed, in _hang \(faulty_server"
    ):
        run(process, "hang", limit=0.5)
    assert time.monotonic() - start < 10
    assert run(process, "none")["position"].shape == (3, 2)


def test_a_message_is_read_as_it_was_written() -> None:
    written: dict[str, Any] = {
        "columns": np.arange(6.0).reshape(2, 3).T,
        "number": 0.1,
        "yes": True,
        "text": "μ λ_N",
        "nothing": "",
        "none": np.zeros((0, 3)),
        "numbers": [1, 2],
    }
    stream = io.BytesIO()
    write_message(stream, written)
    write_message(stream, {})
    stream.seek(0)
    read = read_message(stream)
    assert list(read) == list(written)
    for name, value in written.items():
        assert np.array_equal(read[name], np.asarray(value))
        assert read[name].dtype.kind == np.asarray(value).dtype.kind
    read["columns"][0] = 1.0
    assert read_message(stream) == {}
    with pytest.raises(EOFError):
        read_message(stream)


@pytest.mark.parametrize(
    "array", [1, ("|O", (1,), bytes(8)), ("<f8", (2,), bytes(8)), ("<f8", (-2,), b""), ("x", (), b"")]
)
def test_what_holds_no_arrays_is_no_message(array: object) -> None:
    whole = pickle.dumps({"a": array})
    for sent in (whole, whole[:-1], b"Warning", pickle.dumps(array)):
        with pytest.raises(NotAMessage):
            read_message(io.BytesIO(sent))


@pytest.mark.parametrize("trouble", ["garble", "half"])
def test_a_garbled_reply_is_refused_and_the_next_use_starts_afresh(process: EngineProcess, trouble: str) -> None:
    with pytest.raises(EngineProcessError, match=r"sent something other than a reply|ended with code 0"):
        run(process, trouble)
    assert run(process, "none")["position"].shape == (3, 2)


def test_an_exception_comes_with_its_traceback_and_the_worker_lives_on(process: EngineProcess) -> None:
    with pytest.raises(EngineProcessError, match="ArithmeticError: the solver lost its way") as caught:
        run(process, "raise")
    assert "faulty_server.py" in "".join(caught.value.__notes__)
    with pytest.raises(EngineProcessError, match="SystemExit: no licence"):
        run(process, "leave")
    with pytest.raises(EngineProcessError, match="ValueError: no spring is that stiff"):
        run(process, "refuse")
    assert run(process, "none")["position"].shape == (3, 2)
    assert process.generation == 1


def test_an_error_whose_text_no_file_takes_is_shown(process: EngineProcess) -> None:
    with pytest.raises(EngineProcessError) as caught:
        run(process, "mumble")
    assert str(caught.value).endswith("ArithmeticError: no file \\udc80 \\x1b[2J")
    assert run(process, "none")["position"].shape == (3, 2)


def test_a_version_whose_text_no_file_takes_is_shown(tmp_path: Path) -> None:
    server = tmp_path / "server.py"
    server.write_text("def versions():\n    return {'engine': '1\\udc80'}\n")
    process = EngineProcess("tested", sys.executable, server)
    assert out_of_process._versions_or_reason(process)["engine"] == "1\\udc80"
    process.close()


def test_what_an_engine_prints_disturbs_nothing(process: EngineProcess, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(process, "print")["position"].shape == (3, 2)
    assert capfd.readouterr() == ("", "")


def test_the_worker_sees_nothing_of_this_environment(
    process: EngineProcess, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("LD_LIBRARY_PATH", str(tmp_path))
    reply = {name: str(value) for name, value in process.request("versions", LIMIT).items()}
    assert str(tmp_path) not in reply["path"]
    assert "LD_LIBRARY_PATH" not in reply["environment"]
    # Else a server called siconos.py would hide the package.
    assert str(SERVER.parent) not in reply["path"].split(os.pathsep)
    assert not {"multibody_xval", "reference_lcp", "scipy"} & set(reply["modules"].split())
    assert reply["read"] == ""


@pytest.mark.slow
def test_an_interrupted_wait_does_not_mix_up_replies(process: EngineProcess) -> None:
    def interrupt(_number: int, _frame: object) -> None:
        raise KeyboardInterrupt

    previous = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 1.0)
    try:
        with pytest.raises(KeyboardInterrupt):
            run(process, "hang")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, previous)
    assert run(process, "none")["position"].shape == (3, 2)


def test_threads_take_turns(process: EngineProcess) -> None:
    models = [lane_in(process) for _ in range(4)]
    states = [random_state(size=0.1 * (k + 1)) for k in range(4)]
    ends: list[State | None] = [None] * 4

    def work(k: int) -> None:
        for _ in range(20):
            ends[k] = models[k].advance(states[k], 0, 5)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for state, end in zip(states, ends, strict=True):
        assert end is not None
        assert end.positions == pytest.approx(state.positions + 5 * state.velocities)


def test_a_worker_ends_with_its_parent_even_if_that_is_killed() -> None:
    with python(
        "process.request('versions', 30.0); print(process._worker.process.pid, flush=True); sys.stdin.read()"
    ) as parent:
        assert parent.stdout is not None
        worker = int(parent.stdout.readline())
        parent.kill()
    assert ends(worker, 10)


@pytest.mark.slow
def test_a_hanging_worker_of_a_killed_parent_ends_at_its_limit() -> None:
    program = """
        process.request("build", 30.0, number=1, trouble="hang")
        print(process._worker.process.pid, flush=True)
        still = [0.0, 0.0]
        process.request("run", 2.0, number=1, position=still, velocity=still, loads=[0.0], record=True)
    """
    with python(program) as parent:
        assert parent.stdout is not None
        worker = int(parent.stdout.readline())
        time.sleep(0.5)
        parent.kill()
    assert Path(f"/proc/{worker}").exists()
    assert ends(worker, 10)


def test_a_program_that_ends_takes_its_worker_along_without_a_message() -> None:
    parent = python("process.request('versions', 30.0); print(process._worker.process.pid)")
    worker = int(parent.communicate()[0])
    assert parent.returncode == 0
    assert ends(worker, 1)


def test_a_forked_process_has_a_worker_of_its_own() -> None:
    parent = python("""
        process.request("versions", 30.0)
        first = process._worker.process.pid
        fork = os.fork()
        process.request("versions", 30.0)
        if fork == 0:
            os._exit(process._worker.process.pid == first)
        assert os.waitpid(fork, 0)[1] == 0
        process.request("versions", 30.0)
        assert process._worker.process.pid == first
    """)
    parent.communicate()
    assert parent.returncode == 0


def test_a_lane_is_built_again_where_its_worker_was_lost(process: EngineProcess) -> None:
    model = lane_in(process)
    before = model.run(random_state(), 0, 5)
    assert process._worker is not None
    worker = process._worker.process.pid
    os.kill(worker, signal.SIGKILL)
    assert ends(worker, 10)
    assert np.array_equal(model.run(random_state(), 0, 5).positions, before.positions)
    assert process.generation == 2


def test_a_closed_lane_is_built_again_and_a_deleted_one_is_released(process: EngineProcess) -> None:
    model = lane_in(process)
    first = model.run(random_state(), 0, 1)
    model.close()
    assert np.array_equal(model.run(random_state(), 0, 1).positions, first.positions)
    number = model._built.number
    del model
    process.request("versions", LIMIT)
    with pytest.raises(EngineProcessError, match="KeyError"):
        process.request("run", LIMIT, number=number, **STILL)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_state_that_is_not_finite_never_reaches_the_engine(process: EngineProcess, value: float) -> None:
    model = lane_in(process)
    state = random_state()
    state.velocities[0, 3] = value
    with pytest.raises(ParameterError, match=re.escape(f"initial velocities = {value:g}")):
        model.run(state, 0, 1)
    assert process.generation == 0


class Tested(OutOfProcessEngine):
    name = "tested"
    capabilities = Capabilities("Tested", "python3-tested", "MIT", FrictionLaw.COULOMB, {})
    server = SERVER


def test_a_missing_interpreter_is_a_reason_with_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MULTIBODY_XVAL_TESTED_PYTHON", "/nowhere/python3")
    reason = Tested().unavailable_reason()
    assert reason is not None
    assert "/nowhere/python3 does not start" in reason
    remedy = "apt install python3-tested, or let MULTIBODY_XVAL_TESTED_PYTHON name a Python that has it"
    assert reason.startswith(remedy)


def test_a_python_without_the_engine_is_tried_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    server, log = tmp_path / "server.py", tmp_path / "log"
    server.write_text(f"open({str(log)!r}, 'a').write('asked ')\nimport no_such_engine\n")
    monkeypatch.setattr(Tested, "server", server)
    monkeypatch.setenv("MULTIBODY_XVAL_TESTED_PYTHON", sys.executable)
    reasons = {Tested().unavailable_reason() for _ in range(3)}
    assert len(reasons) == 1
    assert str(reasons.pop()).endswith("No module named 'no_such_engine')")
    assert log.read_text() == "asked "
    Tested().process().close()


def test_an_interpreter_that_never_answers_is_given_up(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    interpreter = tmp_path / "python"
    interpreter.write_text("#!/bin/sh\nexec sleep 100\n")
    interpreter.chmod(0o755)
    monkeypatch.setattr("multibody_xval.engines.isolated.process.GRACE", 0.1)
    silent = EngineProcess("tested", str(interpreter), SERVER)
    with pytest.raises(EngineProcessError, match=r"tested does not answer 'versions' within 0\.1 s"):
        silent.request("versions", 0.1)
    assert not silent.alive()
