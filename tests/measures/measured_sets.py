"""The models beside measured drops, tosses and impact ratios: `python -m tests.measures.measured_sets [drops|tosses|ratios]`.

It wants the data folder, and some ten minutes of processor.
"""

import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from harness.questions.validate.validation_run import validate_measured
from harness.records.validation import MeasuredRecord
from reports.messages import ENGLISH
from reports.pages.validation_page import measured_table
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
    return measured("squares/square_drops.csv.gz", SCENES / "square_drop.toml")


def tosses() -> str:
    """Tosses of a cube."""
    return measured("tosses/cube_tosses.csv.gz", SCENES / "cube_toss.toml", TOSS_MODELS)


def ratios() -> str:
    """First impacts of limestone blocks."""
    return measured("impacts/limestone_first_impacts.csv")


def measured(name: str, body: Path | None = None, models: Sequence[str] | None = None) -> str:
    """What is told of a set of the data folder."""
    with tempfile.TemporaryDirectory() as folder:
        return told(validate_measured(DATA / name, Path(folder) / "out", body=body, models=models))


if __name__ == "__main__":
    renew_tables(PAGE, MODULE, {"drops": drops, "tosses": tosses, "ratios": ratios}, sys.argv[1:])
