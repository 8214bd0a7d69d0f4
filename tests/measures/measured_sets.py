"""The models beside measured drops, tosses and impact ratios: `python -m tests.measures.measured_sets [drops|tosses|ratios]`.

It wants the data folder, and some ten minutes of processor.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path
from typing import Final

from harness.questions.validate.drop_run import validate_drops
from harness.questions.validate.impact_ratios import validate_ratios
from harness.questions.validate.toss_run import validate_tosses
from harness.records.validation import MeasuredRecord
from reports.messages import ENGLISH
from reports.pages.measured_page import measured_table
from tests.measures.pages import DOCS, renew_tables, table

MODULE: Final = "tests.measures.measured_sets"
PAGE: Final = "measured/measured_sets.md"
SCENES: Final = DOCS.parent / "scenes"
DATA: Final = Path(os.environ.get("ROCKCHECK_DATA", DOCS.parents[1] / "shared" / "data"))
TOSS_MODELS: Final = ("spatial", "pybullet", "pybullet:plain")
LONG: Final = ("drops", "tosses", "poses", "losses", "groups")


def told(record: MeasuredRecord) -> str:
    """The answer, and the tables that are short."""
    said = "" if record.answer is None else record.texted(ENGLISH.say).answer.text  # type: ignore[union-attr]
    tables = (measured_table(each, ENGLISH) for each in record.tables if each.name not in LONG)
    return f"{said}\n\n" + "\n\n".join(
        table(map(str, each.heads), (map(str, row) for row in each.rows)) for each in tables
    )


def drops() -> str:
    """Planar drops of a square."""
    with tempfile.TemporaryDirectory() as folder:
        square = SCENES / "square_drop.toml"
        return told(validate_drops(DATA / "squares" / "square_drops.csv.gz", Path(folder) / "out", square))


def tosses() -> str:
    """Tosses of a cube."""
    with tempfile.TemporaryDirectory() as folder:
        cube, measured = SCENES / "cube_toss.toml", DATA / "tosses" / "cube_tosses.csv.gz"
        return told(validate_tosses(measured, Path(folder) / "out", cube, models=TOSS_MODELS))


def ratios() -> str:
    """First impacts of limestone blocks."""
    with tempfile.TemporaryDirectory() as folder:
        return told(validate_ratios(DATA / "impacts" / "limestone_first_impacts.csv", Path(folder) / "out"))


if __name__ == "__main__":
    renew_tables(PAGE, MODULE, {"drops": drops, "tosses": tosses, "ratios": ratios}, sys.argv[1:])
