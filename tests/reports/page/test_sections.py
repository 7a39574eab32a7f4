"""A section of another package stands in the report; one that fails leaves the others standing."""

import sys
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from multibody_xval.reports.data.report import Report
from multibody_xval.reports.figures.drawing import Drawing
from multibody_xval.reports.page import section as parts
from multibody_xval.reports.page.render import page, sections
from multibody_xval.reports.page.section import ENTRY_POINT_GROUP, Section
from multibody_xval.reports.page.sections import OpenPoints

TEMPLATE = "<p>{{ count }} points & {{ name }}</p>{{ figure('residuals') }}"


class Residuals(Section):
    """Periodicity residuals, as a laboratory of its own might want them."""

    title = "Residuals"
    template = "residuals"
    templates = "laboratory"

    def figures(self) -> list[Drawing]:
        canvas = Figure()
        canvas.subplots().semilogy([point.result.residual for point in self.result.points if point.result.converged])
        return [Drawing("residuals", "Residuals", canvas)]

    def context(self) -> dict[str, Any]:
        return {"count": len(self.result.points), "name": "<none>"}


class Broken(Section):
    """A section with a mistake."""

    title = "Broken"
    template = "residuals"
    templates = "laboratory"

    def context(self) -> dict[str, Any]:
        raise KeyError("<nothing>")


@pytest.fixture
def laboratory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "laboratory"
    (package / "templates").mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "templates" / "residuals.html").write_text(TEMPLATE)
    monkeypatch.syspath_prepend(tmp_path)
    yield
    sys.modules.pop("laboratory", None)


@pytest.mark.usefixtures("laboratory")
def test_a_section_of_another_package_is_rendered_with_its_figure(report: Report) -> None:
    rendered = page("A page", [Residuals(report), OpenPoints(report)])
    assert f"<p>{len(report.result.points)} points & &lt;none&gt;</p>" in rendered.html
    assert 'data-figure="residuals"' in rendered.html
    assert set(rendered.figures) == {"residuals.svg", "residuals.pdf"}
    assert "Points that do not agree" in rendered.html


@pytest.mark.usefixtures("laboratory")
def test_a_section_that_fails_says_so_and_leaves_the_others(report: Report, capsys: pytest.CaptureFixture[str]) -> None:
    rendered = page("A page", [Broken(report), OpenPoints(report)])
    assert "This section failed: KeyError: &#39;&lt;nothing&gt;&#39;" in rendered.html
    assert "Points that do not agree" in rendered.html
    assert "Broken" in capsys.readouterr().err


def test_registered_sections_stand_before_how_the_numbers_were_made(
    report: Report, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Entry:
        name = "residuals"

        @staticmethod
        def load() -> type[Section]:
            return Residuals

    def entry_points(*, group: str) -> list[Any]:
        return [Entry] if group == ENTRY_POINT_GROUP else []

    monkeypatch.setattr(parts, "entry_points", entry_points)
    titles = [part.title for part in sections(report)]
    assert titles[-2:] == ["Residuals", "How these numbers were made"]
    assert titles[0] == "Summary"


def test_two_figures_of_one_name_are_refused(report: Report) -> None:
    class Twice(OpenPoints):
        def figures(self) -> list[Drawing]:
            return [Drawing("same", "", Figure())] * 2

    with pytest.raises(ValueError, match="two figures are called 'same'"):
        page("A page", [Twice(report)])
