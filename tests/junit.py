"""A document of JUnit, held to what services of continuous integration take, and read by another program's parser."""

import re
from pathlib import Path
from xml.etree import ElementTree

import junitparser

ALLOWED = {
    "testsuites": ({"name", "tests", "failures", "errors", "time"}, {"testsuite"}),
    "testsuite": ({"name", "tests", "failures", "errors", "skipped", "time"}, {"testcase"}),
    "testcase": ({"classname", "name", "time"}, {"failure", "skipped", "system-out"}),
    "failure": ({"message", "type"}, set()),
    "skipped": ({"message"}, set()),
    "system-out": (set(), set()),
}
"""Attributes, all of them, and children of each element."""


def checked_junit(file: Path, *, tests: int, failures: int) -> junitparser.JUnitXml:
    """Refuse what is no JUnit, or counts wrongly; gives it as the parser reads it."""
    root = ElementTree.parse(file).getroot()
    assert root.tag == "testsuites"
    for element in root.iter():
        attributes, children = ALLOWED[element.tag]
        assert set(element.attrib) == attributes
        assert {child.tag for child in element} <= children
        counts = [element.attrib[name] for name in ("tests", "failures", "errors", "skipped") if name in attributes]
        assert all(re.fullmatch(r"\d+", count) for count in counts)
    document = junitparser.JUnitXml.fromfile(str(file))
    cases = [case for suite in document for case in suite]
    assert len({(case.classname, case.name) for case in cases}) == len(cases), "cases of one name"
    failing = [case for case in cases if any(isinstance(own, junitparser.Failure) for own in case.result)]
    assert (document.tests, document.failures) == (len(cases), len(failing)) == (tests, failures)
    assert sum(suite.tests for suite in document) == tests
    return document
