"""Tests of this folder see the wrong engines; all others do not."""

import pytest


@pytest.fixture(scope="module", autouse=True)
def wrong_engines(install):
    with install("mutations").visible():
        yield
