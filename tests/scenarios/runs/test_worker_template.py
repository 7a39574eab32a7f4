"""Workers are forked from one process that has imported what they need, and no engine; whatever becomes of it."""

import json
import os
import resource
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from multibody_xval.scenarios.runs import local_processes, worker_template
from multibody_xval.scenarios.runs.executor import KILLED
from multibody_xval.scenarios.runs.failures import ExecutorError
from multibody_xval.scenarios.runs.local_processes import LocalExecutor, LocalWorker
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.worker import identity_of
from multibody_xval.scenarios.runs.worker_template import BEGIN_SECONDS, WorkerTemplate
from tests.installed import ENGINE_PACKAGES
from tests.scenarios.runs.builders import ended, running, steady

LIMIT = 60.0
"""Seconds that a batch may take, on a machine that is busy."""

END_SECONDS = 5.0
"""Within which all processes have to end, on a machine that is busy."""

CLOCK_SECONDS = 0.05
"""By how much the clocks of processor time may differ."""


def run(executor: LocalExecutor, engine: str) -> Result:
    """Run a task of an engine."""
    task = steady(variant=engine, cells=1)
    return executor.run_for_client([task], identity_of(task.variant), LIMIT)[0]


lost = pytest.mark.parametrize(
    "signalled",
    [pytest.param(signal.SIGSTOP, id="stopped", marks=pytest.mark.slow), pytest.param(signal.SIGKILL, id="killed")],
)
"""How a process is lost; what is stopped is waited for."""


@pytest.fixture
def own_template(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let executors start templates, which they end, in place of those that tests keep."""
    monkeypatch.setattr(local_processes, "WorkerTemplate", WorkerTemplate)


@pytest.fixture(scope="module")
def shared() -> Iterator[LocalExecutor]:
    """One worker at a time, for tests that only look at a worker without a task so far."""
    with pytest.MonkeyPatch.context() as patched, LocalExecutor(1) as executor:
        patched.setattr(local_processes, "WorkerTemplate", WorkerTemplate)
        patched.delenv("OPENBLAS_NUM_THREADS", raising=False)  # which the tests' own processes have
        executor._worker_for("reference")
        yield executor


@pytest.fixture
def executor() -> Iterator[LocalExecutor]:
    """One worker at a time, whose template has forked a worker for the reference."""
    with LocalExecutor(1) as executor:
        assert run(executor, "reference").status == "converged"
        yield executor


def template_of(executor: LocalExecutor) -> subprocess.Popen[bytes]:
    return executor._template._process


@pytest.mark.usefixtures("own_template")
def test_workers_of_two_engines_are_forked_from_one_process_that_ends_with_them(executor) -> None:
    template = template_of(executor)
    assert run(executor, "mujoco").status == "converged"
    assert template_of(executor) is template
    assert [worker.engine for worker in executor._workers] == ["reference", "mujoco"]
    executor.close()
    assert template.returncode == 0


@pytest.mark.usefixtures("own_template")
def test_workers_import_the_suite_whatever_has_the_names_of_its_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A user's own folder may be first on the path of the program that starts them."""
    for package in ("multibody_xval", "reference_lcp"):
        (tmp_path / package).mkdir()
        (tmp_path / package / "__init__.py").write_text("raise ImportError('not the suite')")
    monkeypatch.syspath_prepend(tmp_path)
    with LocalExecutor(1) as executor:
        assert run(executor, "reference").status == "converged"


@lost
@pytest.mark.usefixtures("own_template")
def test_template_that_is_lost_is_replaced_and_its_workers_go_on(executor, signalled) -> None:
    template = template_of(executor)
    executor._template._requests.settimeout(0.5)
    template.send_signal(signalled)
    assert run(executor, "mujoco").status == "converged"
    assert template.returncode == -signal.SIGKILL
    assert template_of(executor) is not template
    assert [worker.engine for worker in executor._workers if worker.alive()] == ["reference", "mujoco"]
    assert run(executor, "reference").status == "converged"


def supervisor_of(worker: LocalWorker) -> int:
    """Number of the process above a worker."""
    lines = Path(f"/proc/self/fdinfo/{worker._supervisor}").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("Pid:"))


@lost
def test_batch_goes_to_another_worker_where_its_own_was_lost_between_batches(executor, signalled) -> None:
    """One that is stopped seems to live; the limit of a batch that it has not begun with does not hold for it."""
    (worker,) = executor._workers
    supervisor = supervisor_of(worker)
    process = int(Path(f"/proc/{supervisor}/task/{supervisor}/children").read_text())
    os.kill(process, signalled)
    batch, begin = [steady(eta, cells=1) for eta in (0.8, 0.9)], time.monotonic()
    ((same, results),) = executor.run([batch])
    assert time.monotonic() - begin < BEGIN_SECONDS + END_SECONDS
    assert same == batch
    assert [result.status for result in results] == ["converged"] * 2
    assert not running(process)
    assert worker not in executor._workers


@pytest.mark.slow
def test_batch_that_no_worker_begins_with_is_blocked_by_circumstances(executor, monkeypatch) -> None:
    def stopped(worker: LocalWorker, batch, _identity, _limit):
        raise worker._death(None)

    monkeypatch.setattr(LocalWorker, "_exchange", stopped)
    batch = [steady(eta, cells=1) for eta in (0.8, 0.9)]
    results = [result for _, part in executor.run([batch]) for result in part]
    assert [(result.status, result.reason, result.by_engine) for result in results] == [("blocked", KILLED, False)] * 2


class Said:
    """A batch that says something of the worker that reads it."""

    def __init__(self, expression: str):
        self.expression = expression

    def __reduce__(self) -> tuple[Callable[[str], None], tuple[str]]:
        return exec, (f"import os, sys; raise RuntimeError({self.expression})",)


def said(executor: LocalExecutor, expression: str) -> str:
    """Give the value of an expression in a fresh worker."""
    worker = executor._worker_for("reference")
    reason = worker.run([Said(expression)], "", LIMIT).result()[0].reason
    return reason.removeprefix("the task cannot be read in a worker process: RuntimeError: ")


def test_a_worker_that_is_ended_by_what_it_reads_names_the_end(shared) -> None:
    """A module that an engine brings along may end the program when it is imported."""
    assert said(shared, "sys.exit('no license')").endswith("worker process: SystemExit: no license")


def test_fresh_worker_has_imported_the_suite_and_no_engine(shared) -> None:
    folders = Path(worker_template.__file__).parents[2].glob("engines/*/joint.py")
    adapters = {f"multibody_xval.engines.{file.parent.name}" for file in folders}
    assert {
        "multibody_xval.engines.mujoco",
        "multibody_xval.engines.exudyn",
        "multibody_xval.engines.drake",
    } <= adapters
    assert said(shared, f"str({adapters | set(ENGINE_PACKAGES)} & sys.modules.keys())") == "set()"
    assert (
        said(shared, "str({'multibody_xval.scenarios.runs.executor', 'numba', 'scipy'} <= sys.modules.keys())")
        == "True"
    )


def test_fresh_worker_is_out_of_reach_of_the_terminal_and_engines_find_the_folder(shared) -> None:
    """Nor does a signal to the group of the template or of a worker reach a supervisor."""
    for process in ("os.getpid()", "os.getppid()"):
        assert said(shared, f"str({process} == os.getpgid({process}) == os.getsid({process}))") == "True"
    assert said(shared, "os.environ['TMPDIR']") == str(shared._template.folder.path)


def test_template_and_workers_have_one_thread_in_linear_algebra_too(shared) -> None:
    """A fork of a process with more would have their locks, and none to unlock them."""
    process = template_of(shared).pid
    assert [thread.name for thread in Path(f"/proc/{process}/task").iterdir()] == [str(process)]
    product = "sys.modules['numpy'].ones((500, 500)) @ sys.modules['numpy'].ones((500, 500))"
    assert said(shared, f"({product}, len(os.listdir('/proc/self/task')))[1]") == "1"


@pytest.mark.slow
@pytest.mark.usefixtures("own_template")
def test_processor_time_of_workers_counts_as_their_clients(executor) -> None:
    worker = float(said(executor, "(sum(range(2 * 10**7)), __import__('time').process_time())[1]"))
    assert worker > 2 * CLOCK_SECONDS
    template = int(Path(f"/proc/{template_of(executor).pid}/schedstat").read_text().split()[0]) / 1e9
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    executor.close()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    assert used > template + worker - CLOCK_SECONDS


def descriptors() -> list[str]:
    """Descriptors that this process has open."""
    return sorted(file.name for file in Path("/proc/self/fd").iterdir())


REFUSES = """
import os
def refuse(): raise BlockingIOError(11, os.strerror(11))
os.fork = refuse
"""


@pytest.mark.parametrize(
    ("program", "reason"),
    [
        ("raise SystemExit({descriptor})", "the template of workers has ended"),
        (f"{REFUSES}{worker_template._START}", r"\[Errno 11\] Resource temporarily unavailable"),
    ],
    ids=["the template ends", "no process can be forked"],
)
def test_worker_that_cannot_be_started_is_an_error_with_the_reason(monkeypatch, program, reason) -> None:
    monkeypatch.setattr(worker_template, "_START", program)
    before = descriptors()
    with (
        WorkerTemplate() as template,
        pytest.raises(ExecutorError, match=f"^a worker process cannot be started: {reason}$"),
    ):
        template.fork()
    assert descriptors() == before


@pytest.mark.slow
def test_interrupted_start_leaves_neither_processes_nor_descriptors(monkeypatch) -> None:
    started = []

    def interrupt(*_):
        started.append(template._process)
        raise KeyboardInterrupt

    monkeypatch.setattr(socket.socket, "recv", interrupt)
    before = descriptors()
    with WorkerTemplate() as template:
        with pytest.raises(KeyboardInterrupt):
            template.fork()
        assert started[0].returncode is not None
    assert descriptors() == before


CLIENT = """
import json, time
from pathlib import Path
from multibody_xval.scenarios.runs.worker_template import BEGIN_SECONDS, WorkerTemplate
template = WorkerTemplate()
connection, supervisor, crash_log = template.fork()
supervisor = next(line for line in Path(f"/proc/self/fdinfo/{supervisor}").open() if line.startswith("Pid:"))
print(json.dumps([template._process.pid, int(supervisor.split()[1])]), flush=True)
time.sleep(1000)
"""


@pytest.mark.slow
def test_template_that_is_stopped_ends_with_a_client_that_is_killed() -> None:
    client = subprocess.Popen([sys.executable, "-c", CLIENT], stdout=subprocess.PIPE)
    processes = json.loads(client.stdout.readline())
    client.stdout.close()
    assert all(map(running, processes))
    os.kill(processes[0], signal.SIGSTOP)
    client.kill()
    client.wait()
    assert ended(processes, END_SECONDS)


@pytest.mark.usefixtures("own_template")
def test_a_template_that_was_started_before_its_first_worker_is_not_started_again() -> None:
    with LocalExecutor(1) as executor:
        executor.warm_up()
        process = executor._template._process
        assert run(executor, "reference").converged
        assert executor._template._process is process


COMPILED_LATER = """
from numba.core import event
from multibody_xval.scenarios.runs import worker_template
if sys.argv[1:]:
    worker_template._compile_side_by_side()
with event.install_recorder("numba:compile") as compiled:
    worker_template.run_batch([worker_template.WARM_UP])
print(len(compiled.buffer))
"""


@pytest.mark.slow
@pytest.mark.parametrize("aside", [True, False])
def test_two_processes_compile_all_that_a_worker_needs(tmp_path: Path, aside: bool) -> None:
    command = [sys.executable, "-c", f"import sys{COMPILED_LATER}", *["aside"] * aside]
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert (int(ended.stdout) == 0) == aside
