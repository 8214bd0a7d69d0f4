"""A record's file holds plain values, readable where it is short, quick where it is a table; a run comes back whole."""

import json
from pathlib import Path

import numpy as np

from harness.model import MANY, Pattern, Run, write_json
from harness.records.base import part, plain
from tests.harness.runs.test_store import run


def test_a_short_record_is_indented_throughout(tmp_path: Path) -> None:
    record = {"a": [{"x": 1.5, "y": None}] * 3, "b": {"c": ["two\nlines", True]}, "e": {}, "π": "θ"}
    write_json(tmp_path / "record", record)
    assert (tmp_path / "record").read_text() == json.dumps(record, indent=1, ensure_ascii=False) + "\n"


def test_of_a_table_each_row_is_one_line(tmp_path: Path) -> None:
    record = {"rows": [{"number": i, "peak": 0.1 * i} for i in range(MANY + 1)]}
    write_json(tmp_path / "record", record)
    text = (tmp_path / "record").read_text()
    assert json.loads(text) == record
    assert len(text.splitlines()) == MANY + 1 + 4


def test_what_is_no_plain_value_becomes_one(tmp_path: Path) -> None:
    write_json(tmp_path / "record", {"a": np.float64(2.5), "b": float("nan"), "c": np.arange(3), "d": (1, np.int64(2))})
    assert json.loads((tmp_path / "record").read_text()) == {"a": 2.5, "b": None, "c": [0, 1, 2], "d": [1, 2]}


def test_a_run_comes_back_from_its_plain_values() -> None:
    whole = run()
    record = whole
    again = part(Run, plain(record), Path("store"))
    assert plain(again) == plain(record)
    assert again.outcome is whole.outcome
    assert all(isinstance(stretch, Pattern) for stretch in again.patterns)
