"""Do engines agree with the exact motion? ``pytest --pyargs multibody_xval.agreement --xval-engine NAME``."""

from collections.abc import Callable
from typing import Any

import pytest


def test_agrees(xval_check: Any, xval_line: Callable[[Any], tuple[str, str]], request: pytest.FixtureRequest) -> None:
    """Its number is what it should be; see `multibody_xval.scenarios.agreement`."""
    outcome, text = xval_line(xval_check)
    request.node.user_properties.append(("agreement", text))
    if outcome == "failed":
        pytest.fail(text, pytrace=False)
    if outcome == "skipped":
        pytest.skip(text)
