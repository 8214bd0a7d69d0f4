"""One self-contained HTML page per result folder, whatever kind of record it holds, and a plain one for conservators."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Final

from markupsafe import Markup

from harness.model.errors import InputError, Mistake
from harness.model.files import write_text
from harness.model.terminal import printable
from harness.records.base import Record
from harness.records.kinds import read_result
from reports.charts.library import chart_library
from reports.charts.palette import DARK, dark_css
from reports.messages import ENGLISH, Language, language
from reports.messages.numbers import unit
from reports.pages.assets import environment, source_text

REPORT_NAME: Final = "report.html"
CONSERVATOR_NAME: Final = "conservator.html"
CONSERVATOR_PAGES: Final = {
    "run": "reports.pages.conservator",
    "study": "reports.pages.conservator_study",
    "effects3d": "reports.pages.conservator_study",
}
"""Which module knows the conservator's page of a kind of record."""


def write_report(folder: Path, language_code: str = "en") -> Path:
    """Write `report.html` into a result folder from its records alone, and `conservator.html` beside it for a run or a study.

    The second is in the language of that code (`reports.messages.LANGUAGES`).

    Returns the path of the first; raises `InputError` for a broken folder, after every page that can be was written, and what a
    page itself tripped over, with a note that names the page.
    """
    record = read_result(folder).texted(ENGLISH.say)
    mistakes: list[Mistake] = []
    faults: list[Exception] = []
    for name, build in _pages(record, language(language_code)).items():
        try:
            text = build(folder, record)
        except InputError as error:
            mistakes += error.mistakes
        except Exception as fault:  # noqa: BLE001 - raised below: one page's failure must not cost the other
            fault.add_note(name)
            faults.append(fault)
        else:
            write_text(folder / name, text)
    if faults:
        raise faults[0]
    if mistakes:
        raise InputError(dict.fromkeys(mistakes))
    return folder / REPORT_NAME


def _pages(record: Record, say: Language) -> dict[str, Callable[[Path, Record], str]]:
    """What builds each page of a record, by file name."""
    plain = {CONSERVATOR_NAME: partial(_conservator, say=say)} if record.kind in CONSERVATOR_PAGES else {}
    return {REPORT_NAME: _report, **plain}


def _report(folder: Path, record: Record) -> str:
    values = _common(record) | page_values(folder, record)
    scripts = {"script": source_text("page.js"), "units": source_text("units.js")}
    machinery = scripts | {"chart_library": chart_library(), "dark": DARK}
    return _render(f"{record.kind}.html.j2", values | machinery)


def page_values(folder: Path, record: Record) -> dict[str, object]:
    """What the page of a kind of record shows beside the record's own fields."""
    values: dict[str, object] = import_module(f"reports.pages.{record.kind}_page").context(folder, record)
    return values


def _common(record: Record) -> dict[str, object]:
    """What a template sees of any record: its fields as they are, unless its page says them in its own way, and its seconds."""
    seconds = getattr(record, "seconds", None)
    return {**vars(record), "chips": [], "seconds": "" if seconds is None else unit(seconds, "s")}


def _conservator(folder: Path, record: Record, say: Language) -> str:
    return _render("conservator.html.j2", import_module(CONSERVATOR_PAGES[record.kind]).context(folder, record, say))


def _render(template: str, values: Mapping[str, object]) -> str:
    title = printable(str(values["title"]))
    css = source_text("page.css") + Markup(dark_css())
    return environment().get_template(template).render(values, title=title, css=css)
