"""Every kind of page is a list of blocks: its answer first, tables whole, every finding there, every word in each language."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from html import unescape
from pathlib import Path

import pytest

from harness.model import RUN_FIELDS
from harness.records.base import Record
from reports.blocks import Block, Chart, Section, Table, walk
from reports.charts.figure import svg
from reports.messages import ENGLISH, LANGUAGES, language
from reports.pages.page import page_blocks
from tests.reports.every_kind import WRITERS
from tests.reports.page_parts import answer, cell_text, every

NAMES = ("own impact", "level", "own defaults", "slenderness")
"""What the records themselves name: a study's variants, a bench's settings, difficulties."""


@dataclass(frozen=True)
class Page:
    """A written page, its record, and its blocks in each language."""

    file: Path
    record: Record
    blocks: Mapping[str, list[Block]]


@pytest.fixture(scope="module", params=WRITERS)
def page(request: pytest.FixtureRequest, page_of: Callable[[str], Path], record_of: Callable[[str], Record]) -> Page:
    file, record = page_of(request.param), record_of(request.param)
    said = {code: language(code) for code in LANGUAGES}
    blocks = {code: page_blocks(file.parent, record.texted(say.say), say) for code, say in said.items()}
    return Page(file, record, blocks)


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_answer_comes_first_and_what_follows_is_whole(page: Page, code: str) -> None:
    blocks = page.blocks[code]
    told = answer(blocks)
    assert told in [*walk(blocks[:1])]
    assert told.headline
    assert told.tone in ("agree", "differ", "failed")
    sections = every(blocks, Section)
    names = [each.name for each in sections]
    assert names[-1] in ("repeat", "details")
    assert len(set(names)) == len(names)
    assert all(each.blocks for each in sections)
    for found in every(blocks, Table):
        assert found.rows, "a table of nothing is not shown"
        assert {len(row) for row in found.rows} == {len(found.heads)}, found.caption
        assert all(isinstance(cell_text(cell), str) for row in found.rows for cell in row)
        code_names = [
            text for row in found.rows for cell in row if re.fullmatch(r"[a-z]+(_[a-z]+)+", text := cell_text(cell))
        ]
        assert not code_names, "a name of the code where words belong"
    charts = [each.name for each in every(blocks, Chart)]
    assert len(set(charts)) == len(charts)


def test_another_language_says_everything_in_its_own_words(page: Page) -> None:
    english, other = page.blocks["en"], page.blocks["it"]
    headings = [[each.heading for each in every(blocks, Section)] for blocks in (english, other)]
    assert len(headings[0]) == len(headings[1])
    assert all(mine != theirs for mine, theirs in zip(*headings, strict=True))
    captions = [[each.caption for each in every(blocks, Table)] for blocks in (english, other)]
    assert len(captions[0]) == len(captions[1])
    known = {key for key in ENGLISH.strings if key.startswith("table.")}
    assert {ENGLISH.strings[key] for key in known}.isdisjoint(captions[1])
    threshold_of = [ENGLISH.word(name) for name in ("named_share", "other_tests")]
    assert not [caption for caption in captions[1] if any(words in caption for words in threshold_of)]


def test_the_page_shows_every_finding_row_and_chart_and_markup_stays_text(page: Page) -> None:
    html = page.file.read_text(encoding="utf-8")
    shown = unescape(html).replace("\u00a0", " ")
    for each in page.record.findings:
        assert ENGLISH.say(each).replace("\u00a0", " ") in shown or each.code.startswith("pair_"), each.code
    for block in page.blocks["en"]:
        for found in every([block], Table):
            assert unescape(html).count(f"<caption>{found.caption}</caption>") >= 1
        for chart in every([block], Chart):
            assert f'id="chart-{chart.name}"' in html
    assert "<statue>" not in html
    assert html.partition("<h1>")[2].partition("</h1>")[0]
    for version in page.record.versions.values():
        assert version in shown


def words_of(texts: Iterable[str]) -> set[str]:
    """The words of some texts, in small letters; what stands in braces is none."""
    return {word for text in texts for word in re.findall(r"[^\W\d_]{3,}", re.sub(r"\{.*?\}", "", text).lower())}


def read_of(chart: Chart) -> list[str]:
    """What a reader sees of a chart: its title, what is drawn, what stands under the pointer, what is chosen of."""
    drawn = [unescape(text) for text in re.findall(r">([^<>]+)</text>", svg(chart.figure, 900.0))]
    parts = [part for data in chart.figure["datasets"].values() for part in data]
    tips = [tip for part in parts for tip in part.get("tip", [])]
    told = [each["words"] for each in chart.figure.get("usermeta", {}).get("read", []) if each]
    return [
        chart.words,
        *drawn,
        *tips,
        *told,
        *(each["bind"]["name"] for each in chart.figure["params"] if "bind" in each),
    ]


def test_no_chart_of_another_language_has_an_english_word(page: Page) -> None:
    english = words_of(ENGLISH.strings.values()) - words_of(language("it").strings.values())
    assert {"rotation", "until", "pedestal", "share"} <= english
    scenes = [row.scene for row in getattr(page.record, "rows", ()) if hasattr(row, "scene")]
    own = words_of([page.record.title, *scenes, *NAMES])
    for chart in every(page.blocks["it"], Chart):
        assert words_of(read_of(chart)) & english <= own, chart.name


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_runs_values_have_words_and_their_unit_in_each_language(code: str) -> None:
    say = language(code)
    for each in RUN_FIELDS:
        if each.single and each.name not in ("engine", "message"):
            assert f"label.{each.name}" in say.strings
            assert not each.unit or say.label(each.name).endswith(f" [{each.unit}]")
