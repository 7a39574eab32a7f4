"""Every published number is met by the event-driven motion, and the table in the documentation says so."""

import csv

import pytest

from tests.reference_lcp.published.anchors import ANCHORS, ROOT, exact_values


@pytest.fixture(scope="module")
def values() -> dict[str, float]:
    return exact_values()


def test_every_published_number_is_computed(values) -> None:
    assert set(values) == set(ANCHORS)


@pytest.mark.parametrize("name", ANCHORS)
def test_exact_motion_meets_the_published_number(name, values) -> None:
    assert values[name] == pytest.approx(ANCHORS[name].value, abs=ANCHORS[name].uncertainty)


def test_table_in_the_documentation_has_these_values(values) -> None:
    with (ROOT / "docs/targets/exact_values.csv").open(encoding="utf-8") as file:
        table = {row["value"]: float(row["exact motion"]) for row in csv.DictReader(file)}
    assert set(table) == set(values)
    for name, value in values.items():
        assert table[name] == pytest.approx(value, rel=1e-7, abs=1e-12)
