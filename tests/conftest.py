"""Settings of the whole test run, and packages of engines that tests install."""

import os

# Each worker of pytest has a processor: threads of linear algebra would wait for each other's. NumPy reads this once.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from hypothesis import settings

from tests.installed import is_extra, skip_absent
from tests.site import Site

# A run of CI repeats bit for bit; elsewhere every run looks at new examples.
settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what needs an engine that does not come with the suite."""
    for item in filter(is_extra, items):
        item.add_marker("extra")


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip what needs an engine that is absent."""
    skip_absent(item)


@pytest.fixture(scope="module")
def here():
    """Run everything in this process: starting workers takes longer than their work."""
    from contextlib import nullcontext

    from multibody_xval.scenarios.running import evaluate
    from multibody_xval.scenarios.running.processes import ThisProcess

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(evaluate, "local", lambda _workers: nullcontext(ThisProcess()))
        yield


@pytest.fixture(scope="session")
def install(tmp_path_factory: pytest.TempPathFactory):
    """Install a package of `tests`, once in a session."""
    sites: dict[str, Site] = {}

    def installed(package: str) -> Site:
        if package not in sites:
            sites[package] = Site(tmp_path_factory.mktemp(package), package)
        return sites[package]

    return installed
