"""Figures that a folder has already are not drawn again; what is damaged, missing or different is."""

import dataclasses
from pathlib import Path

import pytest

from reports.data.report import Report
from reports.drawing import matplotlib_backend, printing
from reports.drawing.figure import Axis, Figure, Panel, Series
from reports.drawing.matplotlib_backend import drawn
from reports.drawing.printing import INDEX, DrawnFigures, described
from reports.drawing.style import Style
from reports.export.files import files_of, write_all
from reports.page.render import FIGURES, sections


def figures_of(report: Report) -> list[Figure]:
    return [figure for section in sections(report) for figure in section.figures()]


@pytest.fixture
def folder(files: dict[str, bytes], tmp_path: Path) -> Path:
    """A report's folder."""
    write_all(tmp_path, files)
    return tmp_path / FIGURES


def to_be_drawn(report: Report, folder: Path) -> list[str]:
    """Names of the figures that have to be drawn."""
    kept = DrawnFigures(folder)
    return [figure.name for figure in figures_of(report) if kept.files(figure) is None]


def test_the_same_report_again_draws_nothing_and_is_the_same(report, files, folder, monkeypatch) -> None:
    monkeypatch.setattr(matplotlib_backend, "print_files", None)
    assert figures_of(report)
    assert to_be_drawn(report, folder) == []
    again = files_of(report, DrawnFigures(folder))
    assert again.keys() == files.keys()
    names = [name for name in files if name.startswith(f"{FIGURES}/")]
    assert {name: again[name] for name in names} == {name: files[name] for name in names}, "others have the time"


@pytest.mark.parametrize("index", [b"", b"[1, 2", b"[]", b"null", b'{"figure3": 3}', b"\xff"])
def test_without_a_readable_index_everything_is_drawn(report, folder, index) -> None:
    (folder / INDEX).write_bytes(index)
    assert to_be_drawn(report, folder) == [figure.name for figure in figures_of(report)]


def test_a_file_that_was_changed_or_taken_away_is_drawn_again(report, folder) -> None:
    first, second = figures_of(report)[:2]
    file = folder / f"{first.name}.svg"
    file.write_bytes(file.read_bytes()[:-1])
    (folder / f"{second.name}.pdf").unlink()
    assert to_be_drawn(report, folder) == [first.name, second.name]


def test_other_versions_of_what_draws_draw_again(report, folder, monkeypatch) -> None:
    printing._backend.cache_clear()
    monkeypatch.setattr(printing, "version", lambda package: f"another {package}")
    assert to_be_drawn(report, folder) == [figure.name for figure in figures_of(report)]
    printing._backend.cache_clear()


def test_every_part_of_a_description_counts(report) -> None:
    figure = next(figure for figure in figures_of(report) if figure.panels[0].marks)
    panel = figure.panels[0]
    fewer = dataclasses.replace(panel, marks=panel.marks[1:])
    wider = dataclasses.replace(panel, x=dataclasses.replace(panel.x, range=(0.125, 7.0)))
    others = [
        dataclasses.replace(figure, height=figure.height + 1e-12),
        dataclasses.replace(figure, panels=[fewer, *figure.panels[1:]]),
        dataclasses.replace(figure, panels=[wider, *figure.panels[1:]]),
    ]
    assert len({described(each) for each in (figure, *others)}) == 4
    assert described(dataclasses.replace(figure)) == described(figure)


@pytest.mark.parametrize(("draw", "line", "marker"), [("lines", "-", "None"), ("markers", "None", "o")])
def test_a_series_has_lines_or_points_as_it_says(draw, line, marker) -> None:
    axis = Axis("x", (0.0, 1.0))
    series = Series([0.0, 1.0], [0.0, 1.0], Style("#000000"), draw=draw)
    canvas = drawn(Figure("figure", "", [Panel(axis, axis, [series])], 2.0, 200))
    (own,) = canvas.axes[0].get_lines()
    assert str(own.get_linestyle()) == line
    assert str(own.get_marker()) == ("none" if marker == "None" else marker)
