"""The page in a browser: plots have their data, hover tells values, tables sort, every width and paper work."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from reports.export.files import write_all
from tests.reports.page.browser import CHROMIUM, Browser

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium on this machine")

DRAWN = """[...document.querySelectorAll('figure:not([hidden]) .plot')].map(
    (place) => [place.dataset.plot, place.dataset.drawn])"""


@pytest.fixture(scope="module")
def page(files: dict[str, bytes], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    write_all(folder, files)
    return folder / "index.html"


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    opened = Browser(tmp_path_factory.mktemp("profile"))
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def wide(browser: Browser, page: Path) -> Browser:
    """The page at 1440 pixels, with every plot drawn."""
    browser.open(page, 1440)
    browser.run("drawAll()")
    return browser


def test_the_page_loads_and_draws_without_a_complaint(wide: Browser) -> None:
    assert wide.problems == []
    drawn = wide.run(DRAWN)
    assert {state for _, state in drawn} == {"done"}
    assert {name for name, _ in drawn} >= {"figure3", "band-edges", "friction-map", "work-precision", "convergence"}


def test_every_plot_has_its_data(wide: Browser) -> None:
    """What plotly has drawn is what the page holds: as many traces, as many points."""
    counted = """[...document.querySelectorAll('figure:not([hidden]) .plot')].map((place) => {
        const size = (trace) => (trace.z ? trace.z.flat() : trace.y).length;
        return [place.dataset.plot, place.calcdata.length, plots[place.dataset.plot].data.length,
                place.data.map(size), plots[place.dataset.plot].data.map(size)];
    })"""
    for name, drawn, given, sizes, expected in wide.run(counted):
        assert drawn == given > 0, name
        assert sizes == expected, name
        assert sum(sizes) > 1, name


def test_hover_tells_the_values_of_a_point(wide: Browser) -> None:
    """The mouse over the marker of the only steady state at 0.6 in the panel of friction 0.3.

    Two pixels beside its middle: to within a pixel, plotly tells of a point of the line beneath instead.
    """
    place = """(() => {
        const place = document.querySelector('[data-plot="transmittance-0.3"]');
        place.scrollIntoView({block: 'center'});
        const trace = place.data.findIndex((one) => one.name === 'MuJoCo');
        const {xaxis, yaxis} = place._fullLayout;
        const box = place.getBoundingClientRect();
        return [box.left + xaxis._offset + xaxis.d2p(place.data[trace].x[1]),
                box.top + yaxis._offset + yaxis.d2p(place.data[trace].y[1])];
    })()"""
    x, y = wide.run(place)
    wide.move_mouse(x - 40, y + 3)
    wide.move_mouse(x + 2, y + 2)
    told = "new Promise((done) => setTimeout(() => done([...document.querySelectorAll('.hoverlayer text')].map((one) => one.textContent).join('|')), 300))"  # noqa: E501
    text = wide.run(told)
    assert "0.6" in text
    assert {"Reference (LCP)", "MuJoCo"} <= {name.partition(" : ")[0] for name in text.split("|")}, "of all at once"
    assert "2.3125 dB, agree" in text
    assert "MuJoCo" in text


SORTED = """(() => {
    const table = document.querySelector('#%s table');
    const heading = [...table.tHead.rows[0].cells].find((cell) => cell.textContent.startsWith('%s'));
    const index = [...heading.parentNode.children].indexOf(heading);
    const texts = () => [...table.tBodies[0].rows].map((row) => row.cells[index].textContent.trim());
    const before = texts();
    heading.%s;
    return [heading.ariaSort, before, texts()];
})()"""


@pytest.mark.parametrize(
    "press", ["click()", "dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true}))"]
)
def test_tables_sort_by_number_and_back(browser: Browser, page: Path, press: str) -> None:
    """Errors of a hundredth and below: neither in order from the start, nor ordered alike as texts and as numbers."""
    browser.open(page, 1440)
    sort = SORTED % ("work_precision", "largest error", press)
    order, before, values = browser.run(sort)
    numbers = [float(value) for value in values]
    assert order == "ascending"
    assert numbers == sorted(map(float, before)) != list(map(float, before))
    order, _, values = browser.run(sort)
    assert order == "descending"
    assert [float(value) for value in values] == numbers[::-1]


def test_what_has_no_number_comes_after_what_has_one(browser: Browser, page: Path) -> None:
    browser.open(page, 1440)
    _, _, values = browser.run(SORTED % ("stick_slip", "transitions", "click()"))
    assert values[0].isdigit()
    assert values[-1] == "–"


def test_every_row_of_a_table_has_as_many_cells_as_its_heading(browser: Browser, page: Path) -> None:
    browser.open(page, 1440)
    counts = "[...document.querySelectorAll('table.sortable')].map((table) => [table.tHead.rows[0].cells.length, [...new Set([...table.tBodies[0].rows].map((row) => row.cells.length))]])"  # noqa: E501
    tables = browser.run(counts)
    assert tables
    for heading, rows in tables:
        assert rows == [heading]


@pytest.mark.parametrize("width", [1440, 390])
def test_nothing_is_wider_than_the_window(browser: Browser, page: Path, width: int) -> None:
    browser.open(page, width)
    browser.run("drawAll()")
    assert browser.problems == []
    assert browser.run("document.documentElement.scrollWidth") == width
    boxes: list[Any] = browser.run(
        "[...document.querySelectorAll('figure:not([hidden]) .plot')].map((one) => [one.dataset.plot, one.clientWidth, "
        "one.querySelector('.main-svg').getBoundingClientRect().width, one.querySelector('.plot, .draglayer') "
        ".getBoundingClientRect().height, one.clientHeight])"
    )
    assert len(boxes) > 8
    for name, room, drawn, panels, height in boxes:
        assert abs(drawn - room) <= 1, name
        assert panels > 0.35 * height, name  # the legend leaves room for what it explains


def test_plots_follow_a_window_that_is_made_narrow(browser: Browser, page: Path) -> None:
    browser.open(page, 1440)
    browser.run("drawAll()")
    browser.resize(390)
    widths = "new Promise((done) => setTimeout(() => done([...document.querySelectorAll('figure:not([hidden]) .plot')].map((one) => one._fullLayout.width)), 1500))"  # noqa: E501
    drawn = browser.run(widths)
    assert len(drawn) > 8
    assert max(drawn) <= 390


def test_on_paper_every_plot_is_its_printed_figure(browser: Browser, page: Path, tmp_path: Path) -> None:
    browser.open(page, 1440)
    browser.run("drawAll()")
    browser.media("print")
    shown = browser.run(
        "[...document.querySelectorAll('figure.chart:not([hidden])')].map((one) => ["
        "getComputedStyle(one.querySelector('.plot')).display, "
        "one.querySelector('.still').getBoundingClientRect().width])"
    )
    browser.media("screen")
    assert {display for display, _ in shown} == {"none"}
    assert all(width > 100 for _, width in shown)
    browser.print_pdf(tmp_path / "page.pdf")
    assert (tmp_path / "page.pdf").read_bytes().startswith(b"%PDF")


def test_without_scripts_the_printed_figures_stand_on_the_page(browser: Browser, page: Path) -> None:
    browser.open(page, 1440, scripts=False)
    shown = browser.run(
        "[...document.querySelectorAll('figure.chart')].map((one) => [one.querySelectorAll('.main-svg').length, "
        "one.querySelector('.still').getBoundingClientRect().width])"
    )
    assert len(shown) > 8
    assert all(plots == 0 and width > 100 for plots, width in shown)


def test_one_raster_at_a_time_is_shown_and_chosen_from_a_list(browser: Browser, page: Path) -> None:
    browser.open(page, 1440)
    shown = "[...document.querySelectorAll('#rasters figure')].map((one) => !one.hidden)"
    before = browser.run(shown)
    assert len(before) == 2
    assert before == [True, False]
    choose = """(async () => {
        const list = document.querySelector('.choice select');
        list.selectedIndex = 1;
        list.dispatchEvent(new Event('change'));
        const place = document.querySelectorAll('#rasters .plot')[1];
        while (place.dataset.drawn !== 'done') await new Promise((wake) => setTimeout(wake, 20));
    })()"""
    browser.run(choose)
    assert browser.run(shown) == [False, True]
    drawn = "document.querySelectorAll('#rasters figure')[1].querySelector('.main-svg').getBoundingClientRect().width"
    assert browser.run(drawn) > 900


def test_the_first_screen_holds_sentence_drawing_and_picture(browser: Browser, page: Path) -> None:
    """At 1440 x 900, and the way to every section stays in sight."""
    browser.open(page, 1440)
    browser.run("drawAll()")
    bottom = "document.querySelector('%s').getBoundingClientRect().bottom"
    assert browser.run(bottom % ".lead") < browser.run(bottom % ".chain") < 900
    assert browser.run(bottom % "[data-plot=installed] .main-svg") < 900
    browser.run("document.querySelector('#provenance').scrollIntoView()")
    top, last = browser.run("(({top, bottom}) => [top, bottom])(document.querySelector('nav').getBoundingClientRect())")
    assert top == 0
    assert browser.run("document.querySelector('#provenance').getBoundingClientRect().top") >= last - 1


def test_figures_and_tables_fill_the_window(browser: Browser, page: Path) -> None:
    """No third of it stays empty at the right."""
    browser.open(page, 1440)
    browser.run("drawAll()")
    ends = browser.run(
        "[...document.querySelectorAll('section')].map((one) => [one.id, Math.max(0, ...[...one.querySelectorAll("
        "'figure:not([hidden]) .main-svg, .scroll')].map((part) => part.getBoundingClientRect().right))])"
    )
    wide = {name: end for name, end in ends if end}
    assert len(wide) > 6
    assert min(wide.values()) > 1300, wide


def test_tables_fit_a_telephone(browser: Browser, page: Path) -> None:
    """Each row is a card there: no table is wider than its place, and each number has the name of its column."""
    browser.open(page, 390)
    widths = browser.run("[...document.querySelectorAll('.scroll')].map((one) => [one.scrollWidth, one.clientWidth])")
    assert len(widths) > 6
    assert all(inside <= room for inside, room in widths)
    label = "getComputedStyle(document.querySelector('#summary td.n'), '::before').content"
    assert "error to truth" in browser.run(label)


def test_differences_sort_by_their_size(browser: Browser, page: Path) -> None:
    browser.open(page, 1440)
    _, _, values = browser.run(SORTED % ("summary", "difference from", "click()"))
    numbers = [abs(float(value.replace("\u2212", "-"))) for value in values if value != "–"]
    assert numbers == sorted(numbers)
    assert any(value.startswith("\u2212") for value in values)


def test_a_dark_page_has_dark_plots_on_which_the_reference_is_seen(browser: Browser, page: Path) -> None:
    colours = """(() => {
        const place = document.querySelector('[data-plot="transmittance-0.3"]');
        const line = place.data.find((one) => one.name === 'Reference (LCP)').line.color;
        return [getComputedStyle(document.body).backgroundColor, place._fullLayout.paper_bgcolor, line];
    })()"""
    seen = {}
    for scheme in ("light", "dark"):
        browser.media("screen", scheme)
        browser.open(page, 1440)
        browser.run("drawAll()")
        seen[scheme] = browser.run(colours)
    browser.media("screen")
    assert seen["light"] == ["rgb(255, 255, 255)", "#fff", "#000000"]
    assert seen["dark"] == ["rgb(20, 24, 29)", "#14181d", "#f0f3f6"]
