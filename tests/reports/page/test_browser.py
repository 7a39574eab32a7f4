"""The page in a browser: every width, a dark screen and paper work, without scripts and without a network."""

import os
import shutil
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from multibody_xval.reports.export.files import write_all

pytestmark = pytest.mark.slow

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

UNFOLD = "document.querySelectorAll('details').forEach((one) => { one.open = true; })"

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


@pytest.mark.parametrize("width", [1440, 390])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_fits_its_window_and_asks_for_nothing(browser: Browser, address: str, width: int, scheme: str) -> None:
    """What is wider than a telephone is moved sideways in a place of its own."""
    page = browser.new_page(viewport={"width": width, "height": HEIGHT}, color_scheme=scheme)
    problems: list[str] = []
    page.on("console", lambda said: problems.append(said.text))
    page.on("request", lambda asked: problems.append(asked.url))
    page.goto(address)
    page.evaluate(UNFOLD)
    assert page.evaluate("document.documentElement.scrollWidth") == width
    widths = page.evaluate(
        "[...document.querySelectorAll('figure svg')].map((one) => one.getBoundingClientRect().width)"
    )
    page.close()
    assert problems == [address]
    assert len(widths) > 8
    assert min(widths) > 320


def test_every_row_of_a_table_has_as_many_cells_as_its_heading(page: Page) -> None:
    counts = "[...document.querySelectorAll('table:not(:has([colspan]))')].map((table) => [table.tHead.rows[0].cells.length, [...new Set([...table.tBodies[0].rows].map((row) => row.cells.length))]])"  # noqa: E501
    tables = page.evaluate(counts)
    assert tables
    for heading, rows in tables:
        assert rows == [heading]


def test_on_paper_nothing_is_folded_and_every_figure_is_seen(page: Page) -> None:
    page.emulate_media(media="print")
    hidden = page.evaluate(
        "[...document.querySelectorAll('figure svg, details p:not(.downloads), details table')].filter((one) => "
        "!one.checkVisibility({contentVisibilityAuto: true}) || !one.getBoundingClientRect().height).length"
    )
    assert hidden == 0
    assert page.pdf(prefer_css_page_size=True).startswith(b"%PDF")


def test_the_first_screen_holds_finding_table_and_picture(page: Page) -> None:
    """At 1440 x 900, and the way to every section stays in sight."""
    bottom = "document.querySelector('%s').getBoundingClientRect().bottom"
    assert page.evaluate(bottom % ".lead") < page.evaluate(bottom % ".engines") < 900
    assert page.evaluate(bottom % "[data-figure=installed] svg") < 900
    page.evaluate("document.querySelector('#provenance').scrollIntoView()")
    top, last = page.evaluate(
        "(({top, bottom}) => [top, bottom])(document.querySelector('nav').getBoundingClientRect())"
    )
    assert top == 0
    assert page.evaluate("document.querySelector('#provenance').getBoundingClientRect().top") >= last - 1


def test_the_first_table_fits_a_telephone(browser: Browser, address: str) -> None:
    """Each number there has the name of its column; wider tables are moved sideways."""
    page = opened(browser, address, 390)
    inside, room = page.evaluate(
        "(({scrollWidth, clientWidth}) => [scrollWidth, clientWidth])(document.querySelector('.scroll'))"
    )
    label = page.evaluate("getComputedStyle(document.querySelector('#summary .engines td'), '::before').content")
    page.close()
    assert inside <= room
    assert "as installed" in label


def test_a_dark_page_has_figures_in_its_own_colours(browser: Browser, address: str) -> None:
    colours = {}
    for scheme in ("light", "dark"):
        page = opened(browser, address, color_scheme=scheme)
        texts = "[...document.querySelectorAll('figure svg text')].map((one) => getComputedStyle(one).fill)"
        colours[scheme] = set(page.evaluate(texts))
        page.close()
    assert colours == {"light": {"rgb(27, 31, 36)"}, "dark": {"rgb(230, 233, 237)"}}


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


def test_the_first_tab_stop_skips_to_the_content(page: Page) -> None:
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.getAttribute('href')") == "#main"
    page.keyboard.press("Enter")
    assert page.evaluate("location.hash") == "#main"
