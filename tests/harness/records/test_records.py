"""A record is read back as it was written, names its JSON Schema, and damage is told by file and key."""

import json
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest
from typer.testing import CliRunner

from harness import InputError, RunRecord, StudyRecord
from harness.model import write_json
from harness.questions.scene.scene_run import Result, run_scene, write_result
from harness.questions.study.study_record import KeyedRow
from harness.records.base import KINDS, as_file, class_of, plain, read_result, schema_of, validated
from reports.cli import app
from tests.reports.every_kind import WRITERS
from tests.scenes_for_tests import paestum


@pytest.fixture(scope="module")
def result() -> Result:
    return run_scene(paestum(0.429, 3.0, duration_s=1.0), ["analytic", "pymunk"], dt_s=1e-3, assess=True)


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_s_schema_is_printed(kind: str) -> None:
    done = CliRunner().invoke(app, ["schema", kind])
    schema = json.loads(done.stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema["properties"]["kind"]["const"] == kind
    assert schema == schema_of(class_of(kind))


def test_a_kind_that_is_none_has_no_schema() -> None:
    error = CliRunner().invoke(app, ["schema", "runs"]).exception
    assert isinstance(error, InputError)
    assert error.mistakes[0].where == "KIND"


def test_a_record_is_read_as_it_was_written(tmp_path: Path, result: Result) -> None:
    path = write_result(result, tmp_path)
    record = validated(RunRecord, path.read_bytes(), path)
    said = json.loads(path.read_text(encoding="utf-8"))
    assert as_file(record) | {"seal": said["seal"]} == said
    assert record.plain() == plain(replace(result.record(), files=record.files))
    assert record.runs["analytic"].outcome is result.runs["analytic"].outcome


def test_a_result_names_its_schema_and_is_as_that_says(tmp_path: Path, result: Result) -> None:
    written = json.loads(write_result(result, tmp_path).read_text(encoding="utf-8"))
    schema = schema_of(RunRecord)
    valid = jsonschema.Draft202012Validator(schema)
    assert schema["$id"] == written["$schema"]
    assert set(schema["required"]) <= written.keys() <= set(schema["properties"])
    assert valid.is_valid(written)
    assert not valid.is_valid(written | {"kind": "study"})
    assert not valid.is_valid(written | {"runs": {"analytic": {}}})


def test_a_name_that_is_no_utf_8_is_read_as_its_escapes(tmp_path: Path, result: Result) -> None:
    record = as_file(result.record()) | {"title": "o\udcffk 😀"}
    write_json(tmp_path / "result.json", record)
    assert validated(RunRecord, (tmp_path / "result.json").read_bytes(), tmp_path).title == r"o\udcffk 😀"
    assert validated(RunRecord, json.dumps(record), tmp_path).title == r"o\udcffk 😀"


def test_all_mistakes_of_a_record_are_told_by_file_and_key(tmp_path: Path, result: Result) -> None:
    record = json.loads(write_result(result, tmp_path).read_text(encoding="utf-8"))
    del record["scene"]["statue"]["mass_kg"]
    record["runs"]["pymunk"]["outcome"] = "flies"
    record["assessment"]["analytic"]["low"] = "much"
    with pytest.raises(InputError) as caught:
        validated(RunRecord, json.dumps(record), tmp_path / "result.json")
    assert [(item.key, item.got) for item in caught.value.mistakes] == [
        ("scene.statue.mass_kg", "nothing"),
        ("runs.pymunk.outcome", "'flies'"),
        ("assessment.analytic.low", "'much'"),
    ]
    assert {item.where for item in caught.value.mistakes} == {str(tmp_path / "result.json")}
    assert class_of("run") is RunRecord


def test_a_study_writes_of_its_rows_what_its_schema_names(tmp_path: Path) -> None:
    record = read_result(WRITERS["table"](tmp_path / "table"))
    assert isinstance(record, StudyRecord)
    computed = [KeyedRow(**vars(row), key="of the store") for row in record.rows]
    assert as_file(replace(record, rows=computed)) == as_file(record)
