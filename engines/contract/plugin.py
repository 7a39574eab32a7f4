"""The plugin of the contract, on the engines of ``--xval-engine``: a conftest is read too late for an option.

Every session of pytest imports it where the suite is installed: the option has the suite's own prefix, since other
projects have options too, and nothing of the suite is imported before it is used.
"""

import re
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest

OPTION = "--xval-engine"
"""Names an engine that is held to the contract, or compared with the exact motion, or some of its presets."""

XFAILS = "--xfails-file"
"""Names a file of clauses that are known to fail."""

CONTRACT = "multibody_xval.engines.contract"

CAUSES = (
    "test_interface",
    "test_stuck_contact_does_not_creep",
    "test_friction_stays_within_its_bound",
    "test_laws_of_motion",
)
"""Modules and clauses that are run first, in this order: what fails there is why motions differ in others."""

CASE = re.compile(r"(?:engines/contract/|^agreement::).*\[(.+?)(?:-joint|-contact|\])")
"""The engine in a test's name: everything that a clause, or a check of agreement, is run for begins with it."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--xval-engine`` and ``--xfails-file``."""
    group = parser.getgroup("multibody-xval")
    group.addoption(
        XFAILS,
        default="",
        metavar="FILE",
        help="with --xval-engine: tests of the contract that are known to fail, a line each, NODE  # reason",
    )
    group.addoption(
        OPTION,
        action="append",
        default=[],
        metavar="NAME[:FORMULATION[:PRESET]][:OPTION=VALUE]",
        help="with --pyargs multibody_xval.engines.contract: hold this engine to the contract; with --pyargs "
        "multibody_xval.agreement: compare it with the exact motion; in all its formulations and presets, or in those "
        "that are named; without it, all engines that are installed",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Refuse engines that are unknown or not installed, before any test is collected."""
    config.addinivalue_line("markers", "slow: takes seconds, or is of presets, other than tuned, that nobody has named")
    config.addinivalue_line("markers", "needs(engine): is of this engine")
    names: list[str] = config.getoption(OPTION)
    for name in names:
        from multibody_xval.engines.interface.variant import variants_begun
        from reference_lcp.errors import ParameterError

        try:
            variants_begun(name)
        except ParameterError as problem:
            raise pytest.UsageError(f"{OPTION} {name}: {problem}") from None


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Run all clauses for an engine in one worker: what it compiles, and the processes that it starts, serve all."""
    if config.getoption("dist") != "loadscope":
        return None
    from xdist.scheduler import LoadScopeScheduling

    scheduling = LoadScopeScheduling(config, log)
    by_module = scheduling._split_scope
    scheduling._split_scope = lambda name: case[1] if (case := CASE.search(name)) else by_module(name)
    return scheduling


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a clause once for everything that its argument stands for; see `cases.cases`."""
    if metafunc.module.__package__ != CONTRACT:
        return
    from multibody_xval.engines.contract.cases import cases, label

    for argument, chosen in cases(tuple(metafunc.config.getoption(OPTION))).items():
        if argument in metafunc.fixturenames:
            metafunc.parametrize(argument, chosen, ids=None if argument == "installed" else label)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out clauses that an engine says nothing about, run causes first, and mark what is known to fail."""
    asked = [item for item in items if not _is_of_nothing(item)]
    if len(asked) < len(items):
        items[:] = asked
    if config.getoption(OPTION):
        items.sort(key=_place)
    if file := config.getoption(XFAILS):
        from multibody_xval.engines.contract.failures import known_failures, mark_known

        mark_known(items, known_failures(Path(file)))


def _place(item: pytest.Item) -> int:
    """Give the place of a test: in `CAUSES`, or after them where it is another clause of the contract."""
    if not (isinstance(item, pytest.Function) and item.module.__package__ == CONTRACT):
        return -1
    names = item.module.__name__.rpartition(".")[2], item.originalname
    return min((CAUSES.index(name) for name in names if name in CAUSES), default=len(CAUSES))


def _is_of_nothing(item: pytest.Item) -> bool:
    """Whether a clause is run for no preset: pytest makes one test of it that is skipped."""
    return _is_of_the_contract(item) and any(
        mark.kwargs.get("reason", "").startswith("got empty parameter set") for mark in item.iter_markers("skip")
    )


def _is_of_the_contract(item: pytest.Item) -> bool:
    return isinstance(item, pytest.Function) and item.module.__package__ == CONTRACT


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Generator[None, Any, Any]:
    """Print a line for a clause that fails; ``--tb=long`` or ``short`` print how it came to that."""
    report = yield
    problem = call.excinfo.value if call.excinfo else None
    speaks = item.config.option.tbstyle == "auto" and _is_of_the_contract(item)
    if speaks and report.failed and isinstance(problem, AssertionError):
        from multibody_xval.engines.contract.failures import in_a_line

        report.longrepr = in_a_line(item.nodeid, problem)
    return report
