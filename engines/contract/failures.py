"""How the contract speaks: a line for each failure, and failures that a maintainer knows of."""

import re
from pathlib import Path

import pytest

NUMBER = r"(?:np\.float\d+\()?(-?[\d.]+(?:e[-+]?\d+)?|nan|inf)\)?"

COMPARED = re.compile(rf"^assert {NUMBER} (<=|>=|<|>) {NUMBER}")
"""How pytest writes a comparison that is false."""

BOUNDS = {"<=": "at most", "<": "below", ">=": "at least", ">": "above"}


def in_a_line(node: str, problem: BaseException) -> str:
    """Say what was asked of what, what came, and what is allowed."""
    clause, _, of = node.rpartition("::")[2].partition("[")
    asked = clause.removeprefix("test_").replace("_", " ")
    said, *explained = str(problem).splitlines() or [""]
    found = next((COMPARED.match(line) for line in explained if COMPARED.match(line)), None)
    numbers = f": {float(found[1]):.3g}; allowed: {BOUNDS[found[2]]} {float(found[3]):.3g}" if found else ""
    return f"{of.rstrip(']')}: {asked}: {said}{numbers}"


def known_failures(file: Path) -> dict[str, str]:
    """Read a file of tests that are known to fail: ``NODE  # reason`` a line, by the end of the node's name.

    Raises
    ------
    pytest.UsageError
        If it cannot be read, or a line has no reason or a name that another line has.
    """
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as problem:
        raise pytest.UsageError(f"--xfails-file {file} cannot be read: {problem}") from None
    known: dict[str, str] = {}
    for number, line in enumerate(lines, 1):
        node, _, reason = (part.strip() for part in line.partition("#"))
        if not node:
            continue
        if not reason:
            raise pytest.UsageError(f"{file}, line {number}: {node} has no reason; allowed: NODE  # reason")
        if node in known:
            raise pytest.UsageError(f"{file}, line {number}: {node} is there twice; allowed: once")
        known[node] = reason
    return known


def mark_known(items: list[pytest.Item], known: dict[str, str]) -> None:
    """Let tests fail that are known to, and fail where they pass.

    Raises
    ------
    pytest.UsageError
        If a name is of no test.
    """
    for node, reason in known.items():
        own = [item for item in items if item.nodeid.endswith(node)]
        if not own:
            raise pytest.UsageError(
                f"--xfails-file names {node}; allowed: tests that are run, such as {example(items)}"
            )
        for item in own:
            item.add_marker(pytest.mark.xfail(reason=reason, strict=True))


def example(items: list[pytest.Item]) -> str:
    """Give the short name of a test."""
    return items[0].nodeid.rpartition("/")[2] if items else "test_interface.py::test_split_run_equals_whole_run[…]"
