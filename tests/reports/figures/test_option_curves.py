"""One option at a time: variants that differ in one number alone are a curve, and no others are."""

from collections.abc import Mapping
from dataclasses import replace

import pandas as pd
import pytest

from engines.interface.presets import Option
from engines.interface.registry import engine
from engines.interface.variant import Variant
from reports.data.options import option_curves, option_table
from reports.data.points import point_table
from reports.data.report import Report
from reports.data.variants import Errors
from reports.figures.options import SMALLEST_CREEP, option_figure
from reports.page.render import sections
from scenarios.runs.result import Result
from scenarios.sweeps.point import Point
from scenarios.sweeps.sweep import Case
from tests.reports.conftest import made_errors

SWEEPS = {"zero": 0, "three": 3, "fifty": 50}
ERRORS = {"zero": 4.0, "three": 0.3, "fifty": 0.2}
CREEPS = {"zero": 2e-2, "three": 1e-4, "fifty": 0.0}
CASE = Case.of(friction_ratio=0.3)


def with_option(preset: str, name: str, value: object) -> None:
    """Register a preset that is the tuned one of MuJoCo but for an option."""
    tuned = engine("mujoco").preset("joint", "tuned")
    changed = replace(tuned.options.get(name, Option(value, None, "")), value=value)
    presets = engine("mujoco").capabilities.presets["joint"]
    presets[preset] = replace(tuned, options={**tuned.options, name: changed})


@pytest.fixture
def presets(monkeypatch: pytest.MonkeyPatch) -> None:
    every = engine("mujoco").capabilities.presets
    monkeypatch.setitem(every, "joint", dict(every["joint"]))
    for name, value in SWEEPS.items():
        with_option(name, "noslip_iterations", value)


def errors_of(*names: str) -> Errors:
    return made_errors({Variant("mujoco", "joint", name): -ERRORS.get(name, 1.0) for name in names}, points=6)


def points(report: Report, creeps: Mapping[str, float] = CREEPS) -> pd.DataFrame:
    every = [
        Point(
            variant=Variant("mujoco", "joint", name),
            case=CASE,
            frequency_ratio=0.9,
            result=Result(status="converged", creep=(0.0, creep)),
        )
        for name, creep in creeps.items()
    ]
    return point_table(report.result, headline=every)


@pytest.mark.usefixtures("presets")
def test_variants_that_differ_in_one_number_are_a_curve_by_its_value(report: Report) -> None:
    (curve,) = option_curves(errors_of("fifty", "zero", "three", "default"), points(report))
    assert (curve["option"][0], curve["curve"][0]) == ("noslip_iterations", "MuJoCo")
    assert list(curve["value"]) == [0, 3, 50]
    assert list(curve["largest_error_db"]) == [4.0, 0.3, 0.2]
    assert list(curve["largest_creep"]) == [2e-2, 1e-4, 0.0]


@pytest.mark.usefixtures("presets")
def test_two_values_are_no_curve_and_neither_are_variants_that_differ_in_more(report: Report) -> None:
    assert option_curves(errors_of("zero", "three"), points(report, {})) == []
    with_option("other", "impratio", 7.0)
    assert option_curves(errors_of("zero", "three", "other"), points(report, {})) == []
    with_option("fast", "cone", "elliptic of another kind")
    assert option_curves(errors_of("zero", "three", "fast"), points(report, {})) == [], "that is no number"


@pytest.mark.usefixtures("presets")
def test_an_option_that_a_preset_does_not_set_has_the_value_of_the_engine(report: Report) -> None:
    every = engine("mujoco").capabilities.presets["joint"]
    tuned = every["tuned"]
    own = tuned.options["noslip_iterations"]
    every["unset"] = replace(tuned, options={n: o for n, o in tuned.options.items() if o is not own})
    (curve,) = option_curves(errors_of("unset", "three", "fifty"), points(report, {}))
    assert list(zip(curve["value"], curve["preset"], strict=True)) == [
        (own.default, "unset"), (3, "three"), (50, "fifty"),
    ]  # fmt: skip


@pytest.mark.usefixtures("presets")
def test_a_curve_is_drawn_with_its_zero_and_its_creep_and_written_in_full(report: Report) -> None:
    (curve,) = option_curves(errors_of(*SWEEPS), points(report))
    upper, lower = option_figure(1, curve).canvas.axes
    assert [line.get_label() for line in upper.get_lines()[1:]] == ["largest error", "median error"]
    assert list(upper.get_lines()[1].get_xdata()) == [0, 3, 50]
    assert list(lower.get_lines()[0].get_ydata()) == [2e-2, 1e-4, SMALLEST_CREEP], "no creep at all has no logarithm"
    assert [text.get_text() for text in upper.get_xticklabels()] == ["0", "3", "50"]
    table = option_table([curve])
    assert table["largest_creep"].tolist() == [2e-2, 1e-4, 0.0]
    assert table["preset"].tolist() == ["zero", "three", "fifty"]


def test_a_report_without_such_variants_has_no_section_of_them(report: Report) -> None:
    assert "One option at a time" not in [part.title for part in sections(report)]
