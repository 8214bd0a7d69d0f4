"""Every text of the pages stands out from what is drawn under it, in the charts' stills and the pictures too."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.budgets_reports import CONTRAST

pytestmark = pytest.mark.browser

WEAK_TEXT = """
(least) => {
  const numbers = (text) => (text.match(/[\\d.]+/g) || []).map(Number);
  const parts = (text) => { const all = numbers(text); return all.length === 3 ? [...all, 1] : all; };
  const linear = (value) => (value <= 0.03928 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
  const light = ([r, g, b]) => 0.2126 * linear(r / 255) + 0.7152 * linear(g / 255) + 0.0722 * linear(b / 255);
  const over = (top, under) => [0, 1, 2].map((k) => top[3] * top[k] + (1 - top[3]) * under[k]);
  const layer = (item) => {
    const style = getComputedStyle(item), drawn = item instanceof SVGGeometryElement || item instanceof SVGTextElement;
    const colour = parts(drawn ? style.fill : style.backgroundColor);
    if (colour.length < 4 || style.fill.startsWith('url')) return null;
    return [...colour.slice(0, 3), colour[3] * style.opacity * (drawn ? style.fillOpacity : 1)];
  };
  const ground = (item, x, y) => {
    const under = document.elementsFromPoint(x, y).filter((at) => at !== item && !at.closest('header, text'));
    const paper = parts(getComputedStyle(document.body).backgroundColor);
    return under.map(layer).filter(Boolean).reverse().reduce((colour, top) => over(top, colour), paper);
  };
  const weak = [];
  const walker = document.createTreeWalker(document.querySelector('main'), NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode, item = node.parentElement;
    if (!node.textContent.trim() || item.closest('script, style, noscript, title, option, .hidden')) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    if (!range.getBoundingClientRect().width) continue;
    item.scrollIntoView({ block: 'center', inline: 'center', behavior: 'instant' });
    const box = range.getClientRects()[0], x = box.left + box.width / 2, y = box.top + box.height / 2;
    const under = ground(item, x, y), drawn = item.closest('svg');
    const ink = drawn ? layer(item.closest('text')) : parts(getComputedStyle(item).color);
    const [a, b] = [light(over(ink, under)), light(under)];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < least) weak.push([drawn ? 'drawn' : 'written', node.textContent.trim().slice(0, 30), ratio]);
  }
  return weak;
}
"""


@pytest.fixture(scope="module", params=["light", "dark"])
def page(request: pytest.FixtureRequest, browser: Any) -> Iterator[Any]:
    """A page at a desk with its scripts off, so that the stills stay, on a light and on a dark screen."""
    sight = {"viewport": {"width": 1280, "height": 900}, "color_scheme": request.param}
    context = browser.new_context(**sight, java_script_enabled=False)
    yield context.new_page()
    context.close()


@pytest.mark.parametrize("name", ["run", "table", "map", "plain run", "plain table", "plain map"])
def test_text_stands_out_from_what_lies_under_it(page: Any, page_of: Callable[[str], Path], name: str) -> None:
    page.goto(page_of(name).as_uri())
    assert page.evaluate(WEAK_TEXT, CONTRAST) == []


@pytest.mark.parametrize("name", ["run", "plain run"])
def test_the_check_sees_pale_words_and_pale_grounds(page: Any, page_of: Callable[[str], Path], name: str) -> None:
    page.goto(page_of(name).as_uri())
    page.evaluate("document.querySelector('main h1').style.color = '#777'")
    page.evaluate("document.querySelector('main svg text').style.fill = '#777'")
    seen = page.evaluate(WEAK_TEXT, CONTRAST)
    assert sorted(kind for kind, _, _ in seen) == ["drawn", "written"]
