"""One self-contained HTML page per result folder, whatever kind of record it holds, and a plain one for conservators."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Final

from markupsafe import Markup

from harness.model import InputError, Mistake, printable, write_text
from harness.records.base import RECORD, REWRITE, Record, read_result
from reports.blocks import SHOWN_POINTS, Block, Replay, Section, walk
from reports.charts.figure import dark_css
from reports.messages import ENGLISH, Language, language
from reports.pages.assets import chart_library, environment, source_text

REPORT_NAME: Final = "report.html"
CONSERVATOR_NAME: Final = "conservator.html"
FOR_CONSERVATORS: Final = ("run", "study", "effects3d")
"""Kinds of record that have a conservator's page."""


def write_report(folder: Path, language_code: str = "en") -> Path:
    """Write `report.html` into a result folder from its records alone, and `conservator.html` beside it for a run or a study.

    Both are in the language of that code (`reports.messages.LANGUAGES`).

    Returns the path of the first; raises, after every page that can be was written, what the first that cannot tripped over, with
    a note that names the page: `InputError` for a broken folder.
    """
    say = language(language_code)
    read = read_result(folder)
    try:
        record = read.texted(say.say)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        # What a finding's values may be, only its sentence knows.
        wanted = "codes and values as they were written"
        raise InputError(Mistake(str(folder / RECORD), "findings", wanted, repr(error), REWRITE)) from error
    pages = {REPORT_NAME: _report} | ({CONSERVATOR_NAME: _conservator} if record.kind in FOR_CONSERVATORS else {})
    faults: list[Exception] = []
    for name, build in pages.items():
        try:
            write_text(folder / name, build(folder, record, say))
        except Exception as fault:  # noqa: BLE001 - raised below: one page's failure must not cost the other
            fault.add_note(name)
            faults.append(fault)
    if faults:
        raise faults[0]
    return folder / REPORT_NAME


def page_blocks(folder: Path, record: Record, say: Language = ENGLISH) -> list[Block]:
    """The blocks of the engineer's page of a record, whatever its kind."""
    blocks: list[Block] = import_module(f"reports.pages.{record.kind}_page").blocks(folder, record, say)
    return blocks


def _report(folder: Path, record: Record, say: Language) -> str:
    blocks = page_blocks(folder, record, say)
    plain = [(CONSERVATOR_NAME, say("page.plain"))] if record.kind in FOR_CONSERVATORS else []
    names = {each.name: each.heading for each in walk(blocks) if isinstance(each, Section)}
    scripts = ["page.js", "units.js"]
    if any(isinstance(each, Replay) for each in walk(blocks)):
        names = {"replay": say("section.replay"), **names}
        scripts.append("replay.js")
    links = [*plain, *((f"#{name}", words) for name, words in names.items())]
    return _render(record, say(f"kind.{record.kind}"), blocks, links, say, scripts)


def _conservator(folder: Path, record: Record, say: Language) -> str:
    blocks = import_module("reports.pages.conservator").blocks(folder, record, say)
    return _render(record, say("page.kind"), blocks, [(REPORT_NAME, say("page.full_report"))], say)


def _render(
    record: Record,
    kind: str,
    blocks: Sequence[Block],
    links: Sequence[tuple[str, str]],
    say: Language,
    scripts: Sequence[str] = (),
) -> str:
    # These have no title of their own.
    tests = getattr(record, "tests", None) if record.kind == "validation" else None
    title = say.word(record.title) if record.kind in ("bench", "stress") else record.title
    title = title if tests is None else say("text.title_validation", count=tests)
    live = {"chart_library": chart_library()} if scripts else {}
    return environment().get_template("page.html.j2").render(
        live, title=printable(title), kind=kind, blocks=blocks, links=links, say=say,
        css=source_text("page.css") + Markup(dark_css()), scripts=[*map(source_text, scripts)],
        version=record.versions.get("rockcheck", ""), most_points=SHOWN_POINTS,
    )  # fmt: skip
