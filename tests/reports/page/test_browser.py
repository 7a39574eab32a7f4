"""The page in a browser: a telephone, a screen and paper work, without scripts and without a network."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from multibody_xval.reports.page.write import write_page
from multibody_xval.scenarios.store import Stored

if TYPE_CHECKING:  # those who run no slow tests need neither
    from collections.abc import Iterator

    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.slow

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

UNFOLD = "document.querySelectorAll('details').forEach((one) => { one.open = true; })"

HEIGHT = 900
"""Of the window, in pixels."""


@pytest.fixture(scope="module")
def address(stored: list[Stored], stacks: list[Stored], tmp_path_factory: pytest.TempPathFactory) -> str:
    """The address of a page, with drifts and recipes too."""
    folder: Path = tmp_path_factory.mktemp("report")
    return write_page([*stored, *stacks], folder, "multibody-xval report", left_out="Left out: nothing.").page.as_uri()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    if CHROMIUM is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)("there is no chromium on this machine")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


def opened(browser: Browser, address: str, width: int = 1440, **options: Any) -> Page:
    """Open an address in a window of its own, with everything unfolded."""
    page = browser.new_page(viewport={"width": width, "height": HEIGHT}, **options)
    page.goto(address)
    page.evaluate(UNFOLD)
    return page


@pytest.mark.parametrize("width", [1440, 390])
def test_the_page_fits_its_window_and_asks_for_nothing(browser: Browser, address: str, width: int) -> None:
    """What is wider than a telephone is moved sideways in a place of its own."""
    page = browser.new_page(viewport={"width": width, "height": HEIGHT})
    problems: list[str] = []
    page.on("console", lambda said: problems.append(said.text))
    page.on("request", lambda asked: problems.append(asked.url))
    page.goto(address)
    page.evaluate(UNFOLD)
    assert page.evaluate("document.documentElement.scrollWidth") == width
    figures = "[...document.querySelectorAll('figure svg')].map((one) => one.getBoundingClientRect().width)"
    widths = page.evaluate(figures)
    bottom = "document.querySelector('%s').getBoundingClientRect().bottom"
    if width == 1440:  # the first screen holds finding, table and picture
        assert page.evaluate(bottom % ".finding") < page.evaluate(bottom % "#headline table") < HEIGHT
        assert page.evaluate(bottom % "#headline svg") < HEIGHT
    page.close()
    assert problems == [address]
    assert len(widths) > 5
    assert min(widths) > 250


def test_on_paper_nothing_is_folded_and_every_figure_is_seen(browser: Browser, address: str) -> None:
    page = browser.new_page(viewport={"width": 1440, "height": HEIGHT})
    page.goto(address)
    page.emulate_media(media="print")
    hidden = page.evaluate(
        "[...document.querySelectorAll('figure svg, details table, .first summary, .first pre')].filter((one) => "
        "!one.checkVisibility({contentVisibilityAuto: true}) || !one.getBoundingClientRect().height).length"
    )
    assert hidden == 0
    assert page.pdf(prefer_css_page_size=True).startswith(b"%PDF")
    page.close()


def violations(page: Page) -> list[str]:
    """Give the rules of accessibility that a page breaks."""
    from axe_playwright_python.sync_playwright import Axe

    return [own["id"] for own in Axe().run(page).response["violations"]]


@pytest.mark.parametrize(("width", "scheme"), [(1440, "light"), (390, "light"), (1440, "dark")])
def test_everyone_can_read_the_page(browser: Browser, address: str, width: int, scheme: Any) -> None:
    page = opened(browser, address, width, color_scheme=scheme)
    assert violations(page) == []
    page.close()


def test_a_page_that_is_hard_to_read_is_found(browser: Browser, address: str) -> None:
    page = opened(browser, address)
    page.evaluate("document.querySelector('main p').style.color = '#ddd'")
    page.evaluate("document.querySelector('figure svg').replaceChildren()")
    assert {"color-contrast", "svg-img-alt"} <= set(violations(page))
    page.close()
