"""A command that is interrupted, killed, or without room on its disk loses nothing: a second one goes on."""

import contextlib
import re
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import xarray as xr

from multibody_xval.scenarios.model import REFERENCE
from multibody_xval.scenarios.running.evaluate import Means
from multibody_xval.scenarios.store import opened
from multibody_xval.scenarios.sweeps.file import read_sweep
from multibody_xval.scenarios.sweeps.swept import stored_sweep, swept

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform != "linux", reason="worker processes need Linux")]

RUNS = 3000
"""A second of two workers, with the reference's simulation of 100 steps per period."""

PROGRAM = f"""
import sys
from pathlib import Path
from multibody_xval.scenarios.running.evaluate import Means, computed
from multibody_xval.scenarios.model import REFERENCE, Case, Run
from multibody_xval.scenarios.output_files import RunError
cases = [Case(friction_ratio=0.3, frequency_ratio=0.3 + number / {RUNS}, cells=2) for number in range({RUNS})]
try:
    found = computed([Run(REFERENCE, case, 100) for case in cases], Means(store=Path(sys.argv[1]), workers=2))
except KeyboardInterrupt:
    sys.exit(130)
except RunError as problem:
    sys.exit(str(problem))
print(sum(own.result.status == "periodic" for own in found))
"""


@contextlib.contextmanager
def begun(store: Path, *words: str) -> Iterator[subprocess.Popen[str]]:
    """Begin a command in a session of its own, as a terminal's is: one of a background job would ignore Ctrl-C."""
    command, pipe = [sys.executable, *(words or ("-c", PROGRAM, str(store)))], subprocess.PIPE
    with subprocess.Popen(
        command, stdout=pipe, stderr=pipe, text=True, start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509 - this process has no threads
    ) as own:  # fmt: skip
        yield own


def rows(store: Path) -> int:
    """Results that a file has; none where it has no table."""
    with (
        contextlib.suppress(sqlite3.Error),
        contextlib.closing(sqlite3.connect(f"file:{store}?mode=ro", uri=True)) as file,
    ):
        return file.execute("SELECT count(*) FROM results").fetchone()[0]
    return 0


BATCH = REFERENCE.batch_lanes
"""Results that are stored at once."""


def wait_for_rows(store: Path, most: int = 0) -> None:
    """Wait until more results are stored than so many."""
    end = time.monotonic() + 120
    while rows(store) <= most:
        assert time.monotonic() < end, "no result is stored"
        time.sleep(0.02)


def left_of(session: int) -> list[int]:
    """Give the processes of a session that have not ended 5 s after its command."""
    end = time.monotonic() + 5
    while True:
        found = []
        for folder in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                state, _, _, own = (folder / "stat").read_text().rpartition(")")[2].split()[:4]
                found += [int(folder.name)] if int(own) == session and state != "Z" else []
        if not found or time.monotonic() > end:
            return found
        time.sleep(0.1)


def goes_on(store: Path) -> None:
    """A second command computes the rest alone."""
    before = rows(store)
    with begun(store) as again:
        output, error = again.communicate(timeout=300)
    assert output.split() == [str(RUNS)]
    assert f" of {RUNS - before} runs" in error
    assert rows(store) == RUNS
    assert [own.name for own in store.parent.glob(f"{store.name}*")] == [store.name]


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tmp_path / "results.sqlite"


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_after_a_signal_nothing_runs_a_copy_of_the_file_alone_is_whole_and_a_second_command_goes_on(store, how) -> None:
    """But for the last batch, at most."""
    with begun(store) as own:
        wait_for_rows(store, 2 * BATCH)
        own.send_signal(how)
        own.communicate(timeout=30)
    assert own.returncode == (130 if how == signal.SIGINT else -how)
    assert left_of(own.pid) == []
    copy = Path(shutil.copy(store, store.with_name("copy.sqlite")))
    with opened(copy) as found:
        assert 0 < rows(store) - BATCH <= len(list(found.rows())) <= rows(store) < RUNS
    goes_on(store)


def test_a_file_that_cannot_grow_ends_the_command_in_a_line_and_a_second_one_goes_on(store) -> None:
    with begun(store) as own:
        resource.prlimit(own.pid, resource.RLIMIT_FSIZE, (200_000, 200_000))
        _, error = own.communicate(timeout=300)
    assert re.fullmatch(rf"store {store}: .*what is stored stays, run again to go on", error.splitlines()[-1])
    assert "Traceback" not in error
    assert rows(store) > 0
    goes_on(store)


def test_two_commands_share_a_file(store) -> None:
    with begun(store) as one, begun(store) as other:
        outputs = [own.communicate(timeout=300)[0].split() for own in (one, other)]
    assert outputs == [[str(RUNS)], [str(RUNS)]]
    assert rows(store) == RUNS


SWEEP = """
engines = ["reference"]
[grid]
friction_ratio = [0.1, 0.3, 0.5]
frequency_ratio = { first = 0.5, last = 1.5, points = 40 }
cells = [1, 2, 3]
"""


def test_a_sweep_that_is_killed_six_times_goes_on_and_ends_with_the_same_table(store) -> None:
    file = store.with_name("own.toml")
    file.write_text(SWEEP)
    words = f"-m multibody_xval sweep {file} --store {store} --workers 1".split()
    for _ in range(6):
        with begun(store, *words) as own:
            wait_for_rows(store, rows(store))
            own.kill()
        assert own.returncode == -signal.SIGKILL, "the sweep had ended by itself"
    before = rows(store)
    with begun(store, *words) as own:
        own.communicate(timeout=300)
    assert (own.returncode, rows(store) > before) == (0, True)
    data, whole = stored_sweep(read_sweep(file), store), swept(read_sweep(file), Means())
    xr.testing.assert_identical(data.drop_vars("seconds"), whole.drop_vars("seconds"))
