"""The plugin of `multibody_xval.agreement`, and of the fixtures that it gives to users' tests.

Every session of pytest imports it where the suite is installed: nothing of the suite is imported before it is used.
``--xval-engine`` is an option of the contract's plugin.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from multibody_xval.scenarios.agreement.checks import Check
    from multibody_xval.scenarios.agreement.lines import Line
    from multibody_xval.scenarios.agreement.own_simulation import PeriodicMotion

ALLOW = "--xval-allow"
"""Judges levels of presets that are not judged."""

LARGEST_ALLOWED = 1000.0
"""[dB]."""

MODULE, SHORT = "multibody_xval.agreement", "agreement"
"""Module of the checks, and how names of tests begin in place of its path."""

PROPERTY = "agreement"
"""Name of the property of a report that has the line of its check."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--xval-allow``."""
    parser.getgroup("multibody-xval").addoption(
        ALLOW,
        default=None,
        metavar="DB",
        help="with --pyargs multibody_xval.agreement: fail where the level of a preset that is not judged, such as "
        "default options, differs by more from the exact motion",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Refuse what is not allowed, before any test is collected."""
    allowed_db(config)
    config.pluginmanager.register(Lines(config), "multibody_xval_agreement_lines")


def allowed_db(config: pytest.Config) -> float | None:
    """Give what ``--xval-allow`` says."""
    text = config.getoption(ALLOW)
    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value <= LARGEST_ALLOWED:
        raise pytest.UsageError(f"{ALLOW} = {text}; allowed: > 0, up to {LARGEST_ALLOWED:g} [dB]")
    return value


def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> pytest.Module | None:
    """Let names of checks begin with one word in place of a path through an environment."""
    if (module_path.parent.name, module_path.name) != ("multibody_xval", "agreement.py"):
        return None
    module: pytest.Module = pytest.Module.from_parent(parent, path=module_path, nodeid=SHORT)
    return module


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Make a test of every check of the engines of ``--xval-engine``."""
    if metafunc.module.__name__ != MODULE or "xval_check" not in metafunc.fixturenames:
        return
    from multibody_xval.scenarios.agreement.checks import checks, named_configs

    asked = [check for config in named_configs(metafunc.config.getoption("--xval-engine")) for check in checks(config)]
    metafunc.parametrize("xval_check", asked, ids=lambda check: check.label)


@pytest.fixture(scope="session")
def xval_line(request: pytest.FixtureRequest) -> Callable[[Check], Line]:
    """Give what comes of a check: the first one of an engine runs all that are asked of it."""
    from multibody_xval.scenarios.agreement.lines import line_of
    from multibody_xval.scenarios.agreement.measured import Key, Measured, key, measured

    items = (item for item in request.session.items if isinstance(item, pytest.Function))
    asked: list[Check] = [
        cast("Check", item.callspec.params["xval_check"]) for item in items if item.nodeid.startswith(f"{SHORT}::")
    ]
    found: dict[Key, Measured] = {}

    def line(check: Check) -> Line:
        if key(check) not in found:
            found.update(measured([own for own in asked if own.config.engine == check.config.engine]))
        return line_of(found[key(check)], allowed_db(request.config))

    return line


@pytest.hookimpl(tryfirst=True)
def pytest_report_teststatus(report: pytest.CollectReport | pytest.TestReport) -> tuple[str, str, str] | None:
    """Let a line stand in place of the letter of a check; the summary, which comes later, has the usual word."""
    return (report.outcome, "", "") if line_in(report) and not hasattr(report, PRINTED) else None


NEW = "\n"

PRINTED = "xval_printed"
"""Attribute of reports whose line is there."""


def line_in(report: pytest.CollectReport | pytest.TestReport) -> str:
    """Give the line of a check that has just been made; empty where a report is of anything else."""
    return dict(report.user_properties).get(PROPERTY, "") if getattr(report, "when", "") == "call" else ""


class Lines:
    """Prints the lines of checks as they come."""

    def __init__(self, config: pytest.Config):
        self._config = config

    @pytest.hookimpl(trylast=True)
    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Print the line of a check."""
        terminal: Any = self._config.pluginmanager.get_plugin("terminalreporter")
        line = line_in(report)
        if terminal is None or not line or self._config.option.verbose < -1:
            return
        setattr(report, PRINTED, True)
        word = "FAILED " if report.failed else "skipped " if report.skipped else ""
        begun = terminal.currentfspath is not None  # the name of the file, which is not to be written before each line
        terminal.write(f"{NEW * begun}{word}{line}{NEW * (not begun)}", red=report.failed, yellow=report.skipped)


@pytest.fixture(scope="session")
def exact_motion() -> Callable[..., PeriodicMotion]:
    """Give the function that finds the exact steady state of a chain: ``exact_motion(friction_ratio=0.3, ...)``."""
    from multibody_xval.scenarios.agreement.own_simulation import exact_motion

    return exact_motion


@pytest.fixture(scope="session")
def steady_state_of() -> Callable[..., PeriodicMotion]:
    """Give the function that finds the steady state of a user's own simulation: ``steady_state_of(step, exact)``."""
    from multibody_xval.scenarios.agreement.own_simulation import steady_state_of

    return steady_state_of
