"""Which quick tests execute which line of the product: every process of a run of pytest writes it into `FOLDER`.

Compiled functions are not seen. `python -m tests.mutations.code` starts such a run.
"""

import json
import os
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import pytest

FOLDER = "MUTATIONS_LINES"
"""Names the variable of the environment with the folder."""

MAPPED_IN = 1800.0
"""Seconds after which no test begins any more."""

ORDER = ("reference_lcp", "scenarios", "reports", "engines")
"""Folders of tests that are mapped: wrong engines and golden answers take too long."""

Lines = Mapping[tuple[str, int], Sequence[tuple[float, str]]]
"""Seconds and name of every test by the file and the line that it executes."""


class Watch:
    """Notes lines and seconds of every test of this process."""

    def __init__(self, folder: Path) -> None:
        import coverage

        self._end, self._seconds = time.monotonic() + MAPPED_IN, dict[str, float]()
        self._useless = set[str]()
        self._file = folder / f"{os.getpid()}.json"
        self._lines = coverage.Coverage(data_file=None, config_file=False, include=[f"{Path.cwd()}/*"])
        self._lines.start()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if not report.passed:
            self._useless.add(report.nodeid)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self._lines.switch_context(item.nodeid)
        begin = time.monotonic()
        try:
            return (yield)
        finally:
            if item.nodeid not in self._useless:
                self._seconds[item.nodeid] = time.monotonic() - begin
            self._lines.switch_context("")

    def pytest_runtest_setup(self) -> None:
        if time.monotonic() > self._end:
            pytest.skip("time is up")

    def pytest_sessionfinish(self) -> None:
        self._lines.stop()
        data = self._lines.get_data()
        files = {str(Path(file).relative_to(Path.cwd())): file for file in data.measured_files()}
        lines = {name: data.contexts_by_lineno(file) for name, file in files.items() if not name.startswith("tests")}
        self._file.write_text(json.dumps({"seconds": self._seconds, "lines": lines}))


def pytest_configure(config: pytest.Config) -> None:
    if FOLDER in os.environ and (hasattr(config, "workerinput") or config.getoption("numprocesses") in (0, None)):
        config.pluginmanager.register(Watch(Path(os.environ[FOLDER])))


def lines_of(project: Path, folder: Path) -> Lines:
    """Run the quick tests of a project, and give those that pass of each line, the fastest first."""
    folders = [f"tests/{room}" for room in ORDER if (project / "tests" / room).is_dir()]
    folders += [str(file.relative_to(project)) for file in sorted((project / "tests").glob("test_*.py"))]
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "tests.mutations.lines", *folders]
    environment = os.environ | {"PYTHONPATH": str(project), FOLDER: str(folder)}
    with (folder / "output.txt").open("w") as output:
        subprocess.run(command, cwd=project, env=environment, stdout=output, stderr=output, check=False)
    found: dict[tuple[str, int], list[tuple[float, str]]] = defaultdict(list)
    for written in map(json.loads, map(Path.read_text, folder.glob("*.json"))):
        seconds = written["seconds"]
        for file, lines in written["lines"].items():
            for line, tests in lines.items():
                found[file, int(line)] += [(seconds[test], test) for test in tests if test in seconds]
    return {place: sorted(tests) for place, tests in found.items() if tests}
