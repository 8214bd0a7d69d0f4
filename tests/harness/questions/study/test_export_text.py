"""A table for a spreadsheet holds no formula that a user's text would begin, and its numbers stay numbers; of a run that failed
there are none."""

import csv
from pathlib import Path

import pytest

from harness.accuracy.refinement import failed
from harness.model import NUMBERS, Outcome
from harness.questions.study.study_record import cell, flat
from harness.runs.store import PlannedRow
from harness.runs.task import answer_of
from reports.cli import studies
from tests.harness.questions.study.small_study import STUDY, written


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1", "\n=1", "＝1"])
def test_text_that_begins_a_formula_is_text(text: str) -> None:
    assert cell(text) == f"'{text}"


@pytest.mark.parametrize("value", [-1.5, 0, None, True, "stands", "a=b", ""])
def test_anything_else_is_as_it_was(value: object) -> None:
    assert cell(value) is value


def test_an_exported_study_holds_no_formula(tmp_path: Path) -> None:
    hostile = '=HYPERLINK("http://a","b")'
    small = STUDY.replace('"own"', f"'{hostile}'").replace("count = 6", "count = 2").replace("count = 5", "count = 2")
    path = written(tmp_path, small)
    studies.run(path, tmp_path / "out", jobs=1, quiet=True, export=tmp_path / "rows.csv")
    with (tmp_path / "rows.csv").open(newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    assert rows[0][0] == "number"
    cells = [text for row in rows for text in row]
    assert f"'{hostile}" in cells
    assert not [text for text in cells if text[:1] in ("=", "+", "@")]
    assert all(float(text) < 0.0 for text in cells if text.startswith("-")), "only numbers begin with a minus"


def test_a_run_that_failed_has_no_numbers() -> None:
    record = answer_of(failed("pymunk", Outcome.CRASHED, "the process died"), histories=False).record
    line = flat(PlannedRow(3, "pymunk", "key", "every_case", {"contact.statue": 0.5}, record))
    assert [line[name] for name in ("number", "contact.statue", "outcome", "impacts")] == [3, 0.5, "crashed", 0]
    assert line["message"] == "the process died"
    assert {line[name] for name in NUMBERS} == {None}
