"""Two versions of one engine on one page: how far they are from each other, and nothing where they are the same."""

import dataclasses

import pytest

from engines.interface.variant import Variant
from reports.data.report import Report
from reports.page.render import page, sections
from scenarios.runs.result import Result
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.point import Truth
from scenarios.sweeps.sweep import Sweep

NEW, OLD = Variant("mujoco"), Variant("mujoco@3.3.7")


def with_old_version(report: Report, off_db: float) -> Report:
    """Add an older version that is off at one point by so many dB; nothing of it needs to be installed."""
    result = report.result
    rows = [
        dataclasses.replace(point, reference=dataclasses.replace(point.reference, amplification=1.0))
        for point in result.points
    ]
    old = [dataclasses.replace(point, variant=OLD) for point in rows if point.variant == NEW]
    worst = next(k for k, point in enumerate(old) if (point.case.friction_ratio, point.frequency_ratio) == (0.3, 0.6))
    level = old[worst].result.transmittance_db
    old[worst] = dataclasses.replace(
        old[worst], result=dataclasses.replace(old[worst].result, transmittance_db=level + off_db)
    )
    sweep: Sweep = dataclasses.replace(result.sweep, variants=(*result.sweep.variants, OLD))
    return dataclasses.replace(report, result=ComparedSweep(sweep, [*rows, *old], result.edges))


def test_one_version_has_no_section(report: Report) -> None:
    assert report.versions == []
    assert "Versions side by side" not in [section.title for section in sections(report)]


@pytest.mark.parametrize(("off_db", "differing"), [(0.0, 0), (1e-9, 0), (1e-4, 1)])
def test_only_more_than_both_leave_open_is_a_difference(report: Report, off_db: float, differing: int) -> None:
    (pair,) = with_old_version(report, off_db).versions
    assert (pair["points"], pair["one_sided"], pair["differing"]) == (7, 0, differing)
    assert pair["largest_db"] == pytest.approx(off_db, abs=1e-12)
    assert pair["where"] == ("friction 0.3, η_r = 0.6" if off_db else "")


@pytest.mark.parametrize(("off_db", "differing"), [(0.0, 0), (1e-9, 1)])
def test_without_the_reference_every_difference_counts(report: Report, off_db: float, differing: int) -> None:
    """What residuals leave open is not known then."""
    result = with_old_version(report, off_db).result
    alone = dataclasses.replace(result.sweep, variants=(NEW, OLD))
    missing = {"reference": Result.missing(), "converged": Result.missing(), "truth": Truth()}
    rows = [dataclasses.replace(point, **missing) for point in result.points if point.variant in alone.variants]
    (pair,) = dataclasses.replace(report, result=ComparedSweep(alone, rows)).versions
    assert (pair["points"], pair["differing"]) == (7, differing)


def test_both_versions_are_named_on_the_page(report: Report) -> None:
    changed = with_old_version(report, 1e-4)
    shown = [section for section in sections(changed) if section.template == "versions"]
    html = page("Versions", shown).html
    assert "MuJoCo 3.3.7" in html
    assert "at friction 0.3" in html
