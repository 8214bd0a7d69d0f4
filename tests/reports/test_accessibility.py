"""No page breaks the rules of the web content guidelines (WCAG 2.1, AA) that a program can check; dark screens and print."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from reports.pages.page import write_report
from tests.reports.every_kind import WRITERS

pytestmark = pytest.mark.browser

BROKEN = Path(__file__).with_name("broken_rules.js").read_text(encoding="utf-8")
PLAIN = ("run", "table", "map", "effects")
"""Records with a conservator's page."""


@pytest.fixture(scope="module")
def opened(browser: Any, page_of: Callable[[str], Path]) -> Iterator[Callable[[str, str], Any]]:
    """Opens a page on a screen of one scheme."""
    contexts = {scheme: browser.new_context(color_scheme=scheme) for scheme in ("light", "dark")}

    def visit(name: str, scheme: str) -> Any:
        page = contexts[scheme].new_page()
        page.goto(page_of(name).as_uri())
        if not name.startswith("plain"):
            page.wait_for_selector("html[data-ready=yes]", timeout=60_000)
        return page

    yield visit
    for context in contexts.values():
        context.close()


@pytest.mark.parametrize("name", [*WRITERS, *(f"plain {name}" for name in PLAIN)])
def test_no_rule_is_broken(opened: Callable[[str, str], Any], name: str) -> None:
    page = opened(name, "light")
    assert page.evaluate(BROKEN) == []
    page.close()


@pytest.mark.parametrize("name", ["rose", "effects", "assessment", "comparison", "validation", "bench", "stress"])
def test_it_fits_a_telephone_and_a_sheet(opened: Callable[[str, str], Any], name: str) -> None:
    """No page scrolls sideways on either, and no command is cut at the sheet's edge."""
    page = opened(name, "light")
    for width, height, media in ((390, 844, "screen"), (794, 1123, "print")):
        page.set_viewport_size({"width": width, "height": height})
        page.emulate_media(media=media)
        page.wait_for_function(
            f"document.documentElement.scrollWidth <= {width}", timeout=10_000
        )  # charts follow later
    assert (
        page.evaluate("[...document.querySelectorAll('pre')].filter((x) => x.scrollWidth > x.clientWidth + 1).length")
        == 0
    )
    page.close()


@pytest.mark.parametrize("name", ["bench", "run", "trust", "validation"])
def test_in_italian_it_fits_a_telephone_too(
    browser: Any, written: Callable[[str], Path], tmp_path: Path, name: str
) -> None:
    """Its words are longer."""
    page = browser.new_context(viewport={"width": 390, "height": 844}).new_page()
    page.goto(write_report(shutil.copytree(written(name), tmp_path / name), "it").as_uri())
    page.wait_for_selector("html[data-ready=yes]", timeout=60_000)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.context.close()


def test_what_has_the_focus_is_seen_to_have_it(opened: Callable[[str, str], Any]) -> None:
    page = opened("run", "dark")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    assert page.evaluate("document.activeElement.getBoundingClientRect().left") > 0.0
    for _ in range(3):
        page.keyboard.press("Tab")
        assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"
    page.close()


def test_charts_take_the_dark_colours_and_are_printed_as_light_stills(opened: Callable[[str, str], Any]) -> None:
    page = opened("run", "dark")
    ink = "getComputedStyle(document.querySelector('#chart-histories .live .role-axis-title text')).fill"
    assert page.evaluate(ink) == "rgb(228, 232, 238)"
    page.emulate_media(media="print")
    assert page.locator("#chart-histories > svg.still").is_visible()
    assert not page.locator("#chart-histories > .live").is_visible()
    assert page.evaluate("getComputedStyle(document.body).color") == "rgb(28, 36, 48)"
    page.close()
    other = opened("effects", "dark")
    other.emulate_media(media="print")
    assert other.evaluate("getComputedStyle(document.querySelector('.key')).printColorAdjust") == "exact"
    other.close()


@pytest.mark.parametrize(
    ("spoil", "rule"),
    [
        ("document.documentElement.removeAttribute('lang')", "the page has a language"),
        ("document.querySelector('nav a').textContent = ''", "a control has a name"),
        ("document.querySelector('h2').outerHTML = '<h4>x</h4>'", "no level of heading is skipped"),
        ("document.querySelector('svg.plain').removeAttribute('aria-label')", "a picture or group has a name"),
        ("document.querySelector('main').id = document.querySelector('section').id", "an id stands once"),
    ],
)
def test_the_rules_see_what_breaks_them(opened: Callable[[str, str], Any], spoil: str, rule: str) -> None:
    page = opened("plain run", "light")
    page.evaluate(spoil)
    assert any(text.startswith(rule) for text in page.evaluate(BROKEN))
    page.close()
