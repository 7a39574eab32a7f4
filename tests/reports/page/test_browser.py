"""The page in a browser: plots have their data, hover tells values, tables sort, every width and paper work."""

import os
import shutil
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from reports.export.files import write_all

pytestmark = pytest.mark.slow

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

DRAWN = """[...document.querySelectorAll('figure:not([hidden]) .plot')].map(
    (place) => [place.dataset.plot, place.dataset.drawn])"""

CHOOSE = """(() => {
    const list = document.querySelectorAll('.choice[data-of=panels] select')[%d];
    list.selectedIndex = %d;
    list.dispatchEvent(new Event('change'));
})()"""
"""Chooses from the lists of cases and of engines; the second case is the friction ratio 0.3."""

CHOSEN = '[data-plot="transmittance-0.3"][data-drawn="done"]'

HEIGHT = 900
"""Of the window, in pixels."""


@pytest.fixture(scope="module")
def address(files: dict[str, bytes], tmp_path_factory: pytest.TempPathFactory) -> str:
    """The address of a page."""
    folder = tmp_path_factory.mktemp("report")
    write_all(folder, files)
    return (folder / "index.html").as_uri()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    if CHROMIUM is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)("there is no chromium on this machine")
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


def opened(browser: Browser, address: str, width: int = 1440, **options: Any) -> Page:
    """Open an address in a window of its own."""
    page = browser.new_page(viewport={"width": width, "height": HEIGHT}, **options)
    page.goto(address)
    return page


@pytest.fixture
def page(browser: Browser, address: str) -> Iterator[Page]:
    """The page at 1440 pixels."""
    page = opened(browser, address)
    yield page
    page.close()


@pytest.fixture(scope="module")
def drawn(browser: Browser, address: str) -> Page:
    """The same with every plot drawn; for all tests."""
    page = opened(browser, address)
    page.evaluate(CHOOSE % (0, 1))
    page.evaluate("drawAll()")
    page.wait_for_selector(CHOSEN)
    return page


@pytest.mark.parametrize("width", [1440, 390])
def test_the_page_loads_and_draws_without_a_complaint(browser: Browser, address: str, width: int) -> None:
    page = browser.new_page(viewport={"width": width, "height": HEIGHT})
    problems: list[str] = []
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("console", lambda said: problems.append(said.text) if said.type in ("error", "warning", "assert") else None)
    page.goto(address)
    page.evaluate("drawAll()")
    plots = page.evaluate(DRAWN)
    page.close()
    assert problems == []
    assert {state for _, state in plots} == {"done"}
    assert {name for name, _ in plots} >= {"figure3", "band-edges", "friction-map", "work-precision", "convergence"}


def test_every_plot_has_its_data(drawn: Page) -> None:
    """What plotly has drawn is what the page holds: as many traces, as many points."""
    counted = """[...document.querySelectorAll('figure:not([hidden]) .plot')].map((place) => {
        const size = (trace) => (trace.z ? trace.z.flat() : trace.y).length;
        return [place.dataset.plot, place.calcdata.length, plots[place.dataset.plot].data.length,
                place.data.map(size), plots[place.dataset.plot].data.map(size)];
    })"""
    for name, shown, given, sizes, expected in drawn.evaluate(counted):
        assert shown == given > 0, name
        assert sizes == expected, name
        assert sum(sizes) > 1, name


def test_hover_tells_the_values_of_a_point(drawn: Page) -> None:
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
    x, y = drawn.evaluate(place)
    drawn.mouse.move(x - 40, y + 3)
    drawn.mouse.move(x + 2, y + 2)
    drawn.wait_for_selector(".hoverlayer text:has-text('agree')", state="attached")
    texts = drawn.locator(".hoverlayer text").all_text_contents()
    assert {"Reference (LCP)", "MuJoCo"} <= {name.partition(" : ")[0] for name in texts}, "of all at once"
    text = " ".join(texts)
    assert "0.6" in text
    assert "2.3125 dB, agree" in text
    assert "MuJoCo" in text


SORTED = """(() => {
    const table = document.querySelector('#%s table.sortable');
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
def test_tables_sort_by_number_and_back(page: Page, press: str) -> None:
    """Errors of a hundredth and below: neither in order from the start, nor ordered alike as texts and as numbers."""
    sort = SORTED % ("work_precision", "largest error", press)
    order, before, values = page.evaluate(sort)
    numbers = [float(value) for value in values]
    assert order == "ascending"
    assert numbers == sorted(map(float, before)) != list(map(float, before))
    order, _, values = page.evaluate(sort)
    assert order == "descending"
    assert [float(value) for value in values] == numbers[::-1]


def test_what_has_no_number_comes_after_what_has_one(page: Page) -> None:
    _, _, values = page.evaluate(SORTED % ("stick_slip", "transitions", "click()"))
    assert values[0].isdigit()
    assert values[-1] == "–"


def test_every_row_of_a_table_has_as_many_cells_as_its_heading(page: Page) -> None:
    counts = "[...document.querySelectorAll('table.sortable')].map((table) => [table.tHead.rows[0].cells.length, [...new Set([...table.tBodies[0].rows].map((row) => row.cells.length))]])"  # noqa: E501
    tables = page.evaluate(counts)
    assert tables
    for heading, rows in tables:
        assert rows == [heading]


@pytest.mark.parametrize("width", [1440, 390])
def test_nothing_is_wider_than_the_window(browser: Browser, address: str, width: int) -> None:
    page = opened(browser, address, width)
    page.evaluate("drawAll()")
    assert page.evaluate("document.documentElement.scrollWidth") == width
    boxes: list[Any] = page.evaluate(
        "[...document.querySelectorAll('figure:not([hidden]) .plot')].map((one) => [one.dataset.plot, one.clientWidth, "
        "one.querySelector('.main-svg').getBoundingClientRect().width, one.querySelector('.plot, .draglayer') "
        ".getBoundingClientRect().height, one.clientHeight])"
    )
    page.close()
    assert len(boxes) > 8
    for name, room, drawn, panels, height in boxes:
        assert abs(drawn - room) <= 1, name
        assert panels > 0.35 * height, name  # the legend leaves room for what it explains


def test_plots_follow_a_window_that_is_made_narrow(drawn: Page) -> None:
    problems: list[str] = []
    drawn.on("pageerror", lambda error: problems.append(str(error)))
    drawn.set_viewport_size({"width": 390, "height": HEIGHT})
    widths = "[...document.querySelectorAll('figure:not([hidden]) .plot')].map((one) => one._fullLayout.width)"
    drawn.wait_for_function(f"Math.max(...{widths}) <= 390")
    assert len(drawn.evaluate(widths)) > 8
    assert problems == []
    drawn.set_viewport_size({"width": 1440, "height": HEIGHT})


def test_on_paper_every_plot_is_its_printed_figure(drawn: Page) -> None:
    drawn.emulate_media(media="print")
    shown = drawn.evaluate(
        "[...document.querySelectorAll('figure.chart:not([hidden])')].map((one) => ["
        "getComputedStyle(one.querySelector('.plot')).display, "
        "one.querySelector('.still').getBoundingClientRect().width])"
    )
    assert {display for display, _ in shown} == {"none"}
    assert all(width > 100 for _, width in shown)
    assert drawn.pdf(prefer_css_page_size=True).startswith(b"%PDF")
    drawn.emulate_media(media="screen")


def test_without_scripts_the_printed_figures_stand_on_the_page(browser: Browser, address: str) -> None:
    page = opened(browser, address, java_script_enabled=False)
    shown = page.evaluate(
        "[...document.querySelectorAll('figure.chart')].map((one) => [one.querySelectorAll('.main-svg').length, "
        "one.querySelector('.still').getBoundingClientRect().width])"
    )
    page.close()
    assert len(shown) > 8
    assert all(plots == 0 and width > 100 for plots, width in shown)


def test_one_raster_at_a_time_is_shown_and_chosen_from_a_list(page: Page) -> None:
    shown = "[...document.querySelectorAll('#rasters figure')].map((one) => !one.hidden)"
    before = page.evaluate(shown)
    assert len(before) == 2
    assert before == [True, False]
    choose = """(async () => {
        const list = document.querySelector('.choice[data-of=rasters] select');
        list.selectedIndex = 1;
        list.dispatchEvent(new Event('change'));
        const place = document.querySelectorAll('#rasters .plot')[1];
        while (place.dataset.drawn !== 'done') await new Promise((wake) => setTimeout(wake, 20));
    })()"""
    page.evaluate(choose)
    assert page.evaluate(shown) == [False, True]
    drawn = "document.querySelectorAll('#rasters figure')[1].querySelector('.main-svg').getBoundingClientRect().width"
    assert page.evaluate(drawn) > 900


def test_one_case_and_one_engine_are_chosen_and_the_reference_stands_beside_it(page: Page) -> None:
    panels = "[...document.querySelectorAll('#panels figure')].map((one) => !one.hidden)"
    assert page.evaluate(panels) == [True, False]
    page.evaluate(CHOOSE % (0, 1))
    page.wait_for_selector(CHOSEN)
    assert page.evaluate(panels) == [False, True]
    engines = page.evaluate("[...document.querySelectorAll('select.engines option')].map((one) => one.text)")
    assert engines == ["all", "MuJoCo", "PyBullet"]
    names = """[...document.querySelector('[data-plot="transmittance-0.3"]').data].map((one) => one.name)"""
    assert "MuJoCo" in page.evaluate(names)
    page.evaluate(CHOOSE % (1, 2))
    page.wait_for_function(f"!{names}.includes('MuJoCo')")
    assert "Reference (LCP)" in page.evaluate(names)


def test_the_first_screen_holds_finding_table_and_picture(drawn: Page) -> None:
    """At 1440 x 900, and the way to every section stays in sight."""
    bottom = "document.querySelector('%s').getBoundingClientRect().bottom"
    assert drawn.evaluate(bottom % ".lead") < drawn.evaluate(bottom % ".engines") < 900
    assert drawn.evaluate(bottom % "[data-plot=installed] .main-svg") < 900
    drawn.evaluate("document.querySelector('#provenance').scrollIntoView()")
    top, last = drawn.evaluate(
        "(({top, bottom}) => [top, bottom])(document.querySelector('nav').getBoundingClientRect())"
    )
    assert top == 0
    assert drawn.evaluate("document.querySelector('#provenance').getBoundingClientRect().top") >= last - 1


def test_figures_and_tables_fill_the_window(page: Page) -> None:
    """No third of it stays empty at the right."""
    page.evaluate("drawAll()")
    ends = page.evaluate(
        "[...document.querySelectorAll('section')].map((one) => [one.id, Math.max(0, ...[...one.querySelectorAll("
        "'figure:not([hidden]) .main-svg, .scroll')].map((part) => part.getBoundingClientRect().right))])"
    )
    wide = {name: end for name, end in ends if end}
    assert len(wide) > 6
    assert min(wide.values()) > 1300, wide


def test_tables_fit_a_telephone(browser: Browser, address: str) -> None:
    """Each row is a card there: no table is wider than its place, and each number has the name of its column."""
    page = opened(browser, address, 390)
    widths = page.evaluate("[...document.querySelectorAll('.scroll')].map((one) => [one.scrollWidth, one.clientWidth])")
    assert len(widths) > 6
    assert all(inside <= room for inside, room in widths)
    label = "getComputedStyle(document.querySelector('#summary .engines td'), '::before').content"
    assert "as installed" in page.evaluate(label)
    named = "[...document.querySelectorAll('.cards td.n:not([colspan])')].every((one) => one.dataset.label)"
    assert page.evaluate(named), "folded ones too"
    page.close()


def test_differences_sort_by_their_size(page: Page) -> None:
    _, _, values = page.evaluate(SORTED % ("summary", "difference from", "click()"))
    numbers = [abs(float(value.replace("\u2212", "-"))) for value in values if value != "–"]
    assert numbers == sorted(numbers)
    assert any(value.startswith("\u2212") for value in values)


def test_a_dark_page_has_dark_plots_on_which_the_reference_is_seen(browser: Browser, address: str) -> None:
    colours = """(() => {
        const place = document.querySelector('[data-plot="transmittance-0.3"]');
        const line = place.data.find((one) => one.name === 'Reference (LCP)').line.color;
        return [getComputedStyle(document.body).backgroundColor, place._fullLayout.paper_bgcolor, line];
    })()"""
    seen = {}
    for scheme in ("light", "dark"):
        page = opened(browser, address, color_scheme=scheme)
        page.evaluate(CHOOSE % (0, 1))
        page.wait_for_selector(CHOSEN)
        seen[scheme] = page.evaluate(colours)
        page.close()
    assert seen["light"] == ["rgb(255, 255, 255)", "#fff", "#000000"]
    assert seen["dark"] == ["rgb(20, 24, 29)", "#14181d", "#f0f3f6"]


def test_no_button_of_a_figure_leaves_the_page(drawn: Page) -> None:
    """Four buttons that draw; and no address stands in what the page has drawn, but for names of XML's parts."""
    buttons = drawn.evaluate(
        "[...document.querySelectorAll('.modebar-btn')].map((one) => one.dataset.title ?? one.ariaLabel)"
    )
    assert len(buttons) > 8
    assert set(buttons) == {"Download plot as a PNG", "Zoom", "Pan", "Reset axes"}
    linked = drawn.evaluate(
        "[...document.querySelectorAll('[href], [src], [action]')].flatMap((one) => ['href', 'src', 'action'].map("
        "(name) => one.getAttribute(name))).filter((value) => value && /^(\\w+:)?\\/\\//.test(value))"
    )
    assert linked == []


CONTRASTS = """(() => {
    const parts = (colour) => colour.match(/[\\d.]+/g).map(Number);
    const light = (colour) => parts(colour).slice(0, 3).map((part) => part / 255).map((part) =>
        part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4)
        .reduce((sum, part, k) => sum + part * [0.2126, 0.7152, 0.0722][k], 0);
    const under = (one) => {
        for (let at = one; at; at = at.parentElement) {
            const own = getComputedStyle(at).backgroundColor;
            if ((parts(own)[3] ?? 1) > 0) return own;
        }
        return 'rgb(255, 255, 255)';
    };
    document.querySelectorAll('details').forEach((one) => { one.open = true; });
    const texts = [...document.querySelectorAll('body :not(script):not(svg *)')].filter((one) =>
        [...one.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim()));
    return texts.map((one) => {
        const [first, second] = [light(getComputedStyle(one).color), light(under(one))].sort((a, b) => b - a);
        return [one.outerHTML.slice(0, 120), (first + 0.05) / (second + 0.05)];
    });
})()"""

LEAST_CONTRAST = 4.5
"""Of a text on its ground, by level AA of the Web Content Accessibility Guidelines."""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_text_stands_out_from_its_ground(browser: Browser, address: str, scheme: str) -> None:
    page = opened(browser, address, color_scheme=scheme)
    page.evaluate(
        "document.querySelector('main').insertAdjacentHTML('beforeend', "
        "['agrees', 'modelled', 'inconclusive', 'unmodelled', 'blocked'].map((name) => "
        "`<p class='outcome ${name}'>1</p>`).join('') + [0, 1, 2, 3, 4, 5, 6].map((k) => "
        "`<p class='shade${k}'>1</p>`).join(''))"
    )
    texts = page.evaluate(CONTRASTS)
    page.close()
    assert len(texts) > 200
    assert [text for text, contrast in texts if contrast < LEAST_CONTRAST] == []


def test_on_paper_nothing_is_folded_and_afterwards_it_is_again(page: Page) -> None:
    folded = "[...document.querySelectorAll('details')].map((one) => one.open)"
    before = page.evaluate(folded)
    assert False in before
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert set(page.evaluate(folded)) == {True}
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.evaluate(folded) == before


def test_the_first_tab_stop_skips_to_the_content(page: Page) -> None:
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.getAttribute('href')") == "#main"
    page.keyboard.press("Enter")
    assert page.evaluate("location.hash") == "#main"
