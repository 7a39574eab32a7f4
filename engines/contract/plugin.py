"""The plugin that gives pytest the option ``--engine``: with ``--pyargs``, a conftest would be read too late for it."""

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
