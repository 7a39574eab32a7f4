"""Tests of this folder see the faulty engines; all others do not."""

import pytest


@pytest.fixture(scope="module", autouse=True)
def faulty_engines(install):
    with install("faulty").visible():
        yield
