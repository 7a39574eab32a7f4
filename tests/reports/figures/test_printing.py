"""Figures that several processes draw for print are those that one draws; one that fails says so when asked for."""

import dataclasses
import io

import matplotlib as mpl
import pytest

from reports.data.report import Report
from reports.drawing import printing
from reports.drawing.matplotlib_backend import PIXELS, PRINT_STYLE, drawn, print_files
from reports.drawing.printing import Printer
from reports.page.render import sections


@pytest.fixture(params=[2, 1], ids=["two processes", "one"])
def processors(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr(printing.os, "cpu_count", lambda: request.param)
    monkeypatch.setattr(printing, "FEWEST", 1)
    return request.param


@pytest.mark.slow
@pytest.mark.usefixtures("processors")
def test_files_of_figures_are_the_same_however_many_processes_draw_them(report: Report) -> None:
    figures = [figure for section in sections(report) for figure in section.figures()][:3]
    with Printer(figures) as printer:
        assert [printer.files(figure) for figure in figures] == [print_files(figure) for figure in figures]


@pytest.mark.usefixtures("processors")
def test_a_figure_that_cannot_be_drawn_leaves_the_others(report: Report) -> None:
    figures = [figure for section in sections(report) for figure in section.figures()][:2]
    broken = dataclasses.replace(figures[0], height="high")
    with Printer([broken, *figures]) as printer:
        with pytest.raises(Exception, match=r"high|unsupported|type"):
            printer.files(broken)
        assert printer.files(figures[1]) == print_files(figures[1])


@pytest.mark.slow
@pytest.mark.parametrize("dense", [True, False])
def test_files_are_those_that_matplotlib_saves(report: Report, dense: bool) -> None:
    every = [figure for section in sections(report) for figure in section.figures()]
    figure = dataclasses.replace(next(one for one in every if one.name == "friction-map"), dense=dense)  # has pixels
    files, svg, pdf = print_files(figure), io.BytesIO(), io.BytesIO()
    with mpl.rc_context(PRINT_STYLE):
        canvas = drawn(figure)
        if dense:
            canvas.savefig(io.BytesIO(), format="png", dpi=PIXELS)
        else:
            canvas.draw_without_rendering()
        canvas.set_layout_engine("none")
        for file, ending, names in (
            (svg, "svg", ("Creator", "Date", "Format", "Type")),
            (pdf, "pdf", ("Creator", "Producer", "CreationDate")),
        ):
            canvas.savefig(file, format=ending, metadata=dict.fromkeys(names), dpi="figure")
    assert pdf.getvalue() == files["pdf"]
    assert list(map(bytes.strip, svg.getvalue().splitlines())) == files["svg"].splitlines()
