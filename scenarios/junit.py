"""Results as JUnit XML, which services of continuous integration read: a suite a group, a case a point."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

from reference_lcp.terminal import visible


@dataclass(frozen=True)
class JUnitCase:
    """One case."""

    suite: str
    name: str
    """Its name, which differs from those of the other cases of its suite."""
    failure: str = ""
    """Why the command ends with exit code 1, in a line; empty where the case is no reason for it."""
    skipped: str = ""
    """Why nothing is said of it; empty otherwise."""
    output: str = ""
    seconds: float = 0.0


def junit_text(name: str, cases: Iterable[JUnitCase]) -> str:
    """Give cases as one document of ``testsuites``."""
    suites: dict[str, list[JUnitCase]] = {}
    for case in cases:
        suites.setdefault(case.suite, []).append(case)
    every = [case for own in suites.values() for case in own]
    root = ElementTree.Element("testsuites", {"name": visible(name), **_counts(every)})
    for suite, own in suites.items():
        skipped = str(sum(bool(case.skipped) for case in own))
        element = ElementTree.SubElement(
            root, "testsuite", {"name": visible(suite), **_counts(own), "skipped": skipped}
        )
        for case in own:
            _add(element, case)
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def _counts(cases: Sequence[JUnitCase]) -> Mapping[str, str]:
    """Give the attributes that count cases."""
    return {
        "tests": str(len(cases)),
        "failures": str(sum(bool(case.failure) for case in cases)),
        "errors": "0",
        "time": f"{sum(case.seconds for case in cases):.3f}",
    }


def _add(suite: ElementTree.Element, case: JUnitCase) -> None:
    """Add a case to its suite."""
    attributes = {"classname": visible(case.suite), "name": visible(case.name), "time": f"{case.seconds:.3f}"}
    element = ElementTree.SubElement(suite, "testcase", attributes)
    if case.failure:
        ElementTree.SubElement(element, "failure", {"message": visible(case.failure), "type": "failure"})
    elif case.skipped:
        ElementTree.SubElement(element, "skipped", {"message": visible(case.skipped)})
    if case.output:
        ElementTree.SubElement(element, "system-out").text = "\n".join(map(visible, case.output.splitlines()))
