"""What has been checked: three tables with figures of the measured pages, and the page that `make report` makes of them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Final

from harness.model import run as record
from harness.model.finding import Answer, Say, info
from harness.records.result_folder import write_whole
from harness.records.validation import MeasuredRecord, MeasuredTable

ROWS: Final = Path(__file__).with_suffix(".json")
"""Renewed by `python -m tests.measures.checked`."""
PARTS: Final = ("verification", "agreement", "validation")
"""Are the equations solved right; do independent codes say the same; does it happen so?"""
COLUMNS: Final = ("compared", "with", "on_how_many", "figure", "does_not_prove", "source")


def write_checked(folder: Path, say: Say = str) -> MeasuredRecord:
    """Write the record of what has been checked into `folder`."""
    rows = json.loads(ROWS.read_text(encoding="utf-8"))
    found = MeasuredRecord(
        title="What has been checked",
        answer=Answer("checked", [info("checked", checks=sum(len(rows[part]) for part in PARTS))]),
        findings=[],
        about="checked",
        source=ROWS.name,
        tables=[MeasuredTable(part, COLUMNS, rows[part]) for part in PARTS],
        versions=record.versions(),
        machine=record.machine(),
        seconds=0.0,
    )
    return write_whole(folder, found.texted(say))
