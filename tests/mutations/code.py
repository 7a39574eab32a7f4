"""``python -m tests.mutations.code --count 40 --seed 1``: would the tests notice one wrong operator in the product?

A copy of the project gets one operator that is another one, at random. The quick tests are run once to see which lines
each of them executes (`coverage`); a mutant meets those of its line, then those that have most to do with its file.
It is killed by the first test that fails, and survives if those of its line pass, though time may be up before all of
its file have been run. Without tests of its line, or if what fails fails without the change too, it is not decided.
"""

import argparse
import ast
import contextlib
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import pytest

from engines.contract.plugin import OPTION
from engines.interface.registry import engine, engine_names
from tests.mutations.lines import Lines, lines_of

PROJECT = Path(__file__).parents[2]

ROOMS = ("reference_lcp", "engines", "scenarios", "reports")

DECIDED_IN = 60.0
"""Seconds that the tests of one mutant may take, unless said otherwise."""

MOST_TESTS = 40
"""Tests of one line that are run: a line that everything executes is seen by few of them or by none."""

MEMORY = 16 * 2**30
"""Address space of a process that tests a change [bytes]: some changes fill a list for ever."""

KILLED, SURVIVED, UNDECIDED = "killed", "survived", "undecided"

WRONG: dict[type[ast.AST], tuple[str, str]] = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
    ast.Not: ("not ", ""),
}
"""Operators, and what stands in their place."""


@dataclass(frozen=True)
class Change:
    """One operator of a file that is another one."""

    file: Path
    """From the root of the project."""
    line: int
    statement: int
    """First line of what it belongs to, under which its lines may be counted."""
    begin: int
    """Place in the bytes of the file between the operands, where the operator is looked for."""
    operator: type[ast.AST]

    def source(self) -> bytes:
        """Give the file with the change."""
        right, wrong = (text.encode() for text in WRONG[self.operator])
        text = (PROJECT / self.file).read_bytes()
        place = text.index(right, self.begin)
        return text[:place] + wrong + text[place + len(right) :]

    def __str__(self) -> str:
        right, wrong = WRONG[self.operator]
        return f"{self.file}:{self.line}: {right.strip()} → {wrong or 'nothing'}"


def changes_of(file: Path) -> Iterator[Change]:
    """Give every change of a file."""
    text = (PROJECT / file).read_bytes()
    starts = [0, *(place + 1 for place, byte in enumerate(text) if byte == ord("\n"))]
    tree = ast.parse(text)
    begins = sorted({node.lineno for node in ast.walk(tree) if isinstance(node, ast.stmt)})
    for node in ast.walk(tree):
        for (line, column), operator in _operators(node):
            statement = begins[bisect_right(begins, line) - 1]
            yield Change(file, line, statement, starts[line - 1] + column, type(operator))


def _operators(node: ast.AST) -> Iterator[tuple[tuple[int, int], ast.AST]]:
    """Give the operators of a node, and line and column from where on each is looked for."""
    found: list[tuple[ast.expr, ast.AST]] = []
    if isinstance(node, ast.BinOp):
        found = [(node.left, node.op)]
    elif isinstance(node, ast.Compare):
        found = list(zip([node.left, *node.comparators], node.ops, strict=False))
    elif isinstance(node, ast.BoolOp):
        found = [(node.values[0], node.op)]
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield (node.lineno, node.col_offset), node.op
    for operand, operator in found:
        if type(operator) in WRONG and operand.end_lineno is not None and operand.end_col_offset is not None:
            yield (operand.end_lineno, operand.end_col_offset), operator


def product_files() -> list[Path]:
    """Give the files of the product, but for the contract, which is tests."""
    tracked = subprocess.run(["git", "ls-files", *ROOMS], cwd=PROJECT, capture_output=True, text=True, check=True)
    files = map(Path, tracked.stdout.splitlines())
    return [file for file in files if file.suffix == ".py" and file.parts[:2] != ("engines", "contract")]


def tests_of(file: Path) -> list[str]:
    """Give the tests of a file: its own, an adapter's contract, those that name it, golden answers, its folder's."""
    module = ".".join(file.with_suffix("").parts).removesuffix(".__init__")
    every = sorted((PROJECT / "tests").rglob("test_*.py"))
    own = [test for test in every if test.stem in (f"test_{file.stem}", f"test_{file.parent.name}")]
    naming = [test for test in every if re.search(rf"\b{re.escape(module)}\b", test.read_text())]
    folder = PROJECT / "tests" / file.parent
    while not folder.is_dir():
        folder = folder.parent
    beside = sorted(naming, key=lambda test: folder not in test.parents)
    contract = [PROJECT / "engines/contract"] if engines_of(file) else []
    tests = dict.fromkeys([*own, *contract, *beside, PROJECT / "tests/golden", folder])
    return [str(test.relative_to(PROJECT)) for test in tests]


def engines_of(file: Path) -> list[str]:
    """Name the installed engines whose adapter is in the folder of a file."""
    adapters = {name: type(engine(name)).__module__.split(".") for name in engine_names()}
    own = [name for name, module in adapters.items() if tuple(module[:2]) == file.parts[:2]]
    return [name for name in own if engine(name).unavailable_reason() is None]


def executing(change: Change, lines: Lines) -> list[str]:
    """Give the tests that execute the line of a change: all examples of those of its file, then one of each other."""
    places = [(str(change.file), line) for line in range(change.line, change.statement - 1, -1)]
    tests = next((lines[place] for place in places if place in lines), [])
    near = set(tests_of(change.file))
    of_file, others = list[str](), dict[str, str]()
    for _, test in tests:  # the fastest first
        if test.partition("::")[0] in near:
            of_file.append(test)
        else:
            others.setdefault(test.partition("[")[0], test)
    return [*of_file, *others.values()][:MOST_TESTS]


def outcome(change: Change, copy: Path, tests: Sequence[str] = (), seconds: float = DECIDED_IN) -> str:
    """Run tests, and then those of its file, on a change in a copy of the project."""
    spoilt = copy / change.file
    sound = spoilt.read_bytes()
    spoilt.write_bytes(change.source())
    environment = os.environ | {"PYTHONPATH": str(copy)}
    if not tests and b"numba" in sound:  # what calls it is compiled with it
        environment["NUMBA_CACHE_DIR"] = tempfile.mkdtemp(dir=copy)
    end, otherwise = time.monotonic() + seconds, UNDECIDED
    try:
        if tests and first_failure(tests, copy, environment, seconds):
            return KILLED
        otherwise = SURVIVED if tests else UNDECIDED
        alone = [f"{OPTION}={name}" for name in engines_of(change.file)]
        failed = first_failure([*tests_of(change.file), *alone], copy, environment, end - time.monotonic())
        spoilt.write_bytes(sound)
        if failed is None:
            return SURVIVED
        return UNDECIDED if first_failure([failed, *alone], copy, environment, seconds) else KILLED
    except subprocess.TimeoutExpired:
        return otherwise
    finally:
        spoilt.write_bytes(sound)


def first_failure(tests: Sequence[str], copy: Path, environment: Mapping[str, str], seconds: float) -> str | None:
    """Name the first test that fails in a copy, or the first of all where the run itself does; nothing outlives it.

    Raises
    ------
    subprocess.TimeoutExpired
        If the tests do not end within these seconds.
    """
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-rfE", "-n", "0", "-p", "no:cacheprovider", *tests]
    with (
        tempfile.TemporaryFile("w+") as output,
        subprocess.Popen(
            command, cwd=copy, env=environment, stdout=output, stderr=output, start_new_session=True
        ) as run,
    ):
        try:
            run.wait(max(seconds, 0.0))
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(run.pid, signal.SIGKILL)  # with all that it has started
        output.seek(0)
        failed = re.search(r"^(?:FAILED|ERROR) ([^\s\[]+)", output.read(), re.MULTILINE)
    if run.returncode in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
        return None
    return failed[1] if failed else tests[0]


def not_killed(every: Sequence[Change], printed: str) -> list[Change]:
    """Give the changes that a run has printed as not killed; all that are named alike, for a line may have several."""
    lines = [line.partition(" ")[::2] for line in printed.splitlines()]
    named = {change.strip() for ended, change in lines if ended in (SURVIVED, UNDECIDED)}
    return [change for change in every if str(change) in named]


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw changes, and print what becomes of each and the score; 1 if any survives."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutations.code", description=__doc__)
    parser.add_argument("--count", type=int, default=40, help="changes that are drawn")
    parser.add_argument("--seed", type=int, default=0, help="of the draw")
    parser.add_argument("--again", type=Path, help="what an earlier run printed: what it did not kill is met again")
    parser.add_argument("--seconds", type=float, default=DECIDED_IN, help="that the tests of one change may take")
    chosen = parser.parse_args(arguments)
    if find_spec("coverage") is None:
        print("coverage is not installed: tests are chosen by file; allowed: pip install -e '.[test]'")
    every = [change for file in product_files() for change in changes_of(file)]
    drawn = random.Random(chosen.seed).sample(every, min(chosen.count, len(every)))
    if chosen.again is not None:
        drawn = not_killed(every, chosen.again.read_text(encoding="utf-8"))
    outcomes: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "project"
        shutil.copytree(PROJECT, copy, ignore=shutil.ignore_patterns(".git", ".venv", ".*_cache", "_build"))
        lines = lines_of(copy, Path(folder)) if find_spec("coverage") else {}
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        for change in drawn:
            ended = outcome(change, copy, executing(change, lines), chosen.seconds)
            outcomes[ended] += 1
            print(f"{ended:9} {change}", flush=True)
    decided = outcomes[KILLED] + outcomes[SURVIVED]
    print(f"{outcomes[KILLED]} of {decided} decided changes are killed; {outcomes[UNDECIDED]} are not decided in time")
    return 1 if outcomes[SURVIVED] else 0


if __name__ == "__main__":
    sys.exit(main())
