"""A saved sweep and its results, damaged at random: refused in one line, or read as they were."""

import random
from collections import Counter
from pathlib import Path

import pytest

from reference_lcp import ParameterError
from reference_lcp.errors import ExitCode
from reference_lcp.process import run_command
from reports.cli.console_script import app
from scenarios.runs.result import Result
from scenarios.runs.store import ResultStore
from scenarios.sweeps.run import save_sweep, saved_sweeps
from scenarios.sweeps.spec_file import read_sweep
from scenarios.sweeps.sweep import Sweep

CONTENT = """
engines = ["reference:joint"]
[grid]
friction_ratio = [0.1, 0.3, 1.0]
frequency_ratio = { first = 0.3, last = 1.6, points = 20 }
"""

PAGE, SECTOR = 4096, 512
"""Sizes of a page of SQLite and of a sector of a disk [bytes]."""


@pytest.fixture(scope="module")
def sweep_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("whole") / "sweep.toml"
    file.write_text(CONTENT)
    return file


@pytest.fixture(scope="module")
def sweep(sweep_file: Path) -> Sweep:
    return read_sweep(sweep_file)


@pytest.fixture(scope="module")
def whole(sweep_file: Path, sweep: Sweep) -> Path:
    """A store of 60 results, each with numbers of its own, and of their sweep."""
    file = sweep_file.with_name("whole.sqlite")
    draw = random.Random(1)
    with ResultStore(file) as store:
        save_sweep(store, sweep)
        for task in sweep.tasks():
            numbers = tuple(draw.random() for _ in range(7))
            turns = tuple((1 + k % 7, draw.random(), "stick" if k % 2 else "forward slip") for k in range(20))
            result = Result(
                status="converged", transmittance_db=-60 * draw.random(), residual=1e-9, periods=30, period=0.25,
                steps_per_period=400, stuck_fraction=numbers, transitions=turns, creep=numbers, seconds=0.1,
            )  # fmt: skip
            store.keep([(task, result)])
    return file


def flipped(content: bytes, draw: random.Random) -> bytes:
    """Damage a file as disks, copies and editors do."""
    changed, place = bytearray(content), draw.randrange(len(content))
    match draw.choice(["bit", "bit", "bits", "header", "zeros", "noise", "cut", "swap", "move", "pages", "append"]):
        case "bit":
            changed[place] ^= 1 << draw.randrange(8)
        case "bits":
            for _ in range(20):
                changed[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
        case "header":
            changed[PAGE * (place // PAGE) + draw.randrange(16)] ^= 1 << draw.randrange(8)
        case "zeros":
            start = SECTOR * (place // SECTOR)
            changed[start : start + SECTOR] = bytes(SECTOR)
        case "noise":
            changed[place : place + 64] = draw.randbytes(len(changed[place : place + 64]))
        case "cut":
            del changed[place:]
        case "swap":
            other = draw.randrange(len(content))
            changed[place], changed[other] = changed[other], changed[place]
        case "move":
            other = draw.randrange(len(content))
            changed[place : place + SECTOR] = content[other : other + len(changed[place : place + SECTOR])]
        case "pages":
            first, second = (PAGE * draw.randrange(1, len(content) // PAGE) for _ in range(2))
            changed[first : first + PAGE] = content[second : second + PAGE]
            changed[second : second + PAGE] = content[first : first + PAGE]
        case "append":
            changed += draw.randbytes(draw.randrange(1, 2 * PAGE))
    return bytes(changed)


class Reader:
    """Reads a store by the commands, and compares what they give with what they give of the whole one."""

    def __init__(self, whole: Path, sweep_file: Path, folder: Path, capsys):
        self.whole, self.sweep_file, self.out, self.capsys = whole, sweep_file, folder / "out.csv", capsys
        self.table = self.swept(whole)

    def refused(self, application, arguments: list[str], file: Path) -> bool:
        """Run a command: one line that names the file and what to do, or none."""
        code = run_command(application, arguments)
        printed = self.capsys.readouterr().err.splitlines()
        assert code in (0, ExitCode.WRONG_INPUT)
        assert len(printed) == (code == ExitCode.WRONG_INPUT)
        if code == ExitCode.WRONG_INPUT:
            assert printed[0].startswith("error: store")
            assert str(file) in printed[0]
            assert "allowed: " in printed[0] or "store check" in printed[0] or "cannot be used" in printed[0]
        return code == ExitCode.WRONG_INPUT

    def swept(self, file: Path) -> bytes | None:
        """Give the table of `sweep --no-run`; nothing where that is refused."""
        self.out.unlink(missing_ok=True)
        line = ["sweep", str(self.sweep_file), "--no-run", "--store", str(file), "--out", str(self.out)]
        return None if self.refused(app, line, file) else self.out.read_bytes().replace(file.name.encode(), b"")

    def outcome(self, file: Path, sweep: Sweep) -> str:
        """Read in every way; whatever is not refused must be as it was."""
        refused = 0
        table = self.swept(file)
        refused += table is None
        assert table in (None, self.table)
        refused += self.refused(app, ["compare", str(self.whole), str(file)], file)
        try:
            noted = saved_sweeps(file).sweep
        except ParameterError:
            refused += 1
        else:
            assert noted == sweep
        return {0: "read as it was", 3: "refused"}.get(refused, "refused in part")


def salvaged(whole: Path, file: Path, tasks: list, capsys) -> str:
    """Save the good rows; each is as it was."""
    new = file.with_name(f"good-{file.name}")
    code = run_command(app, ["store", "check", str(file), "--salvage", str(new)])
    assert len(capsys.readouterr().err.splitlines()) == (code == ExitCode.WRONG_INPUT)
    if code == ExitCode.WRONG_INPUT:
        assert not new.exists()
        return "nothing saved"
    with ResultStore(whole) as store, ResultStore(new) as good:
        expected, results = list(store.results(tasks)), list(good.results(tasks))
    assert all(result in (None, before) for result, before in zip(results, expected, strict=True))
    return "all saved" if None not in results else "some saved"


@pytest.mark.slow
@pytest.mark.parametrize("trials", [40, pytest.param(500, marks=pytest.mark.slow)])
def test_a_damaged_store_is_refused_or_read_as_it_was(whole, sweep_file, sweep, tmp_path, capsys, trials) -> None:
    content, tasks = whole.read_bytes(), list(sweep.tasks())
    reader = Reader(whole, sweep_file, tmp_path, capsys)
    outcomes: Counter[str] = Counter()
    for seed in range(trials):
        file = tmp_path / f"{seed}.sqlite"
        damaged = flipped(content, random.Random(seed)) or b"\0"
        file.write_bytes(damaged)
        outcomes[reader.outcome(file, sweep)] += 1
        outcomes[salvaged(whole, file, tasks, capsys)] += 1
        assert file.read_bytes() == damaged, seed
        assert not list(tmp_path.glob("*.sqlite-*")), "a journal is left behind"
        file.unlink()
    print({name: outcomes[name] for name in sorted(outcomes)})
    assert outcomes["refused"] + outcomes["refused in part"] > trials / 3, "some damage hits free space or no number"
    assert outcomes["some saved"] > trials / 10


def test_a_flipped_bit_of_a_key_hides_no_result(whole, sweep_file, sweep, tmp_path, capsys) -> None:
    """The key of a row stands in the table and in its index; a result that is not found there would seem missing."""
    content, key = whole.read_bytes(), next(sweep.tasks()).key().encode()
    places = [place for place in range(len(content)) if content.startswith(key, place)]
    assert len(places) == 2
    for place in places:
        file = tmp_path / f"{place}.sqlite"
        file.write_bytes(content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :])
        line = ["sweep", str(sweep_file), "--no-run", "--store", str(file), "--out", str(tmp_path / "out.csv")]
        assert run_command(app, line) == ExitCode.WRONG_INPUT
        assert f"store {file} is damaged" in capsys.readouterr().err
        new = tmp_path / f"{place}-good.sqlite"
        assert run_command(app, ["store", "check", str(file), "--salvage", str(new)]) == 0
        assert "damages" in capsys.readouterr().out
