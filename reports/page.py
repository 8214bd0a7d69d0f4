"""One self-contained HTML page per result folder, whatever kind of record it holds, and a plain one for conservators."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from harness.record import write_text
from reports.assets import environment, source_text
from reports.chart_library import chart_library
from reports.source import read_record, telling_damage

REPORT_NAME: Final = "report.html"
CONSERVATOR_NAME: Final = "conservator.html"
CONSERVATOR_KINDS: Final = ("run", "study", "effects3d")
"""The kinds of record that a conservator's page can be written of."""

PAGES: Final = {
    "run": "reports.page_run",
    "assess": "reports.page_assess",
    "study": "reports.page_study",
    "effects3d": "reports.page_effects3d",
    "validation": "reports.page_validation",
    "bench": "reports.page_bench",
    "stress": "reports.page_stress",
}
"""Which module knows each kind of record: its `context(folder, record)` gives the values of its template."""


def write_report(folder: Path) -> Path:
    """Write `report.html` into a result folder from its records alone, and `conservator.html` beside it for a run or a study.

    Returns the path of the first; raises `InputError` for a broken folder.
    """
    record = read_record(folder)
    with telling_damage(folder):
        pages = _pages(folder, record)
    for name, text in pages.items():
        write_text(folder / name, text)
    return folder / REPORT_NAME


def _pages(folder: Path, record: dict[str, Any]) -> dict[str, str]:
    """The texts of a record's pages by file name."""
    build: Callable[[Path, dict[str, Any]], dict[str, Any]] = import_module(PAGES[record["kind"]]).context
    machinery = {"script": source_text("page.js"), "chart_library": chart_library()}
    pages = {REPORT_NAME: _render(f"{record['kind']}.html.j2", build(folder, record) | machinery)}
    if record["kind"] in CONSERVATOR_KINDS:
        from reports.conservator import context

        pages[CONSERVATOR_NAME] = _render("conservator.html.j2", context(folder, record))
    return pages


def _render(template: str, values: Mapping[str, Any]) -> str:
    return environment().get_template(template).render(values, css=source_text("page.css"))
