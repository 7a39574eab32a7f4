"""The plugin that gives pytest the option ``--xval-engine``: with ``--pyargs``, a conftest is read too late for it.

Every session of pytest imports it where the suite is installed: the option has the suite's own prefix, since other
projects have options too, and nothing of the suite is imported before it is used.
"""

import pytest

OPTION = "--xval-engine"
"""Names an engine that is held to the contract."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--xval-engine``."""
    parser.getgroup("multibody-xval").addoption(
        OPTION,
        action="append",
        default=[],
        metavar="NAME",
        help="with --pyargs engines.contract: hold this engine to the contract, in all its formulations and presets; "
        "without it, all that are installed",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Refuse engines that are unknown or not installed, before any test is collected."""
    names: list[str] = config.getoption(OPTION)
    for name in names:
        from engines.interface.registry import engine
        from reference_lcp.errors import ParameterError

        try:
            missing = engine(name).unavailable_reason()
        except ParameterError as problem:
            raise pytest.UsageError(f"{OPTION}: {problem}") from problem
        if missing is not None:
            raise pytest.UsageError(f"{OPTION} {name}: {missing}")
