"""One self-contained HTML page per result folder, whatever kind of record it holds."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from harness.record import write_text
from reports.assets import environment, source_text
from reports.chart_library import chart_library
from reports.source import read_record

REPORT_NAME: Final = "report.html"

PAGES: Final = {
    "run": "reports.page_run",
    "study": "reports.page_study",
    "validation": "reports.page_validation",
    "bench": "reports.page_bench",
    "stress": "reports.page_stress",
}
"""Which module knows each kind of record: its `context(folder, record)` gives the values of its template."""


def write_report(folder: Path) -> Path:
    """Write `report.html` into a result folder from its records alone; raises `InputError` for a broken folder."""
    record = read_record(folder)
    build: Callable[[Path, dict[str, Any]], dict[str, Any]] = import_module(PAGES[record["kind"]]).context
    text = (
        environment()
        .get_template(f"{record['kind']}.html.j2")
        .render(
            build(folder, record),
            css=source_text("page.css"),
            script=source_text("page.js"),
            chart_library=chart_library(),
        )
    )
    path = folder / REPORT_NAME
    write_text(path, text)
    return path
