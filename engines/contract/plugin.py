"""The plugin that gives pytest the option ``--engine``: with ``--pyargs``, a conftest would be read too late for it.

Every session of pytest imports it where the suite is installed, so that it imports nothing of the suite before the
option is used.
"""

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--engine``."""
    parser.getgroup("multibody-xval").addoption(
        "--engine",
        action="append",
        default=[],
        metavar="NAME",
        help="with --pyargs engines.contract: hold this engine to the contract, in all its formulations and presets; "
        "without it, all that are installed",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Refuse engines that are unknown or not installed, before any test is collected."""
    names: list[str] = config.getoption("--engine")
    for name in names:
        from engines.interface.registry import engine
        from reference_lcp.refusal import ParameterError

        try:
            missing = engine(name).unavailable_reason()
        except ParameterError as problem:
            raise pytest.UsageError(f"--engine: {problem}") from problem
        if missing is not None:
            raise pytest.UsageError(f"--engine {name}: {missing}")
