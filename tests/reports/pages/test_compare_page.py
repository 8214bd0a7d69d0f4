"""Two histories of any software compared: a record, a page with a chart, a table in words."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from harness import read_history, read_result
from harness.records.scores import CompareRecord, Verdict
from reports.charts.figure import svg
from reports.cli import app
from reports.cli.app import WRONG_INPUT, guarded
from reports.messages import ENGLISH
from reports.pages.run_page import compare_figure
from tests import doubles


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    history = doubles.rocking(slip_m=0.0101)
    whole, rounded = tmp_path / "whole.csv", tmp_path / "rounded.csv"
    history.write_csv(whole)
    rows = np.column_stack((history.t_s, np.rad2deg(history.theta_rad), 100.0 * history.slip_m))
    np.savetxt(rounded, rows, fmt="%.5g", delimiter=",", header="t_s,theta_deg,slip_cm", comments="")
    return rounded, whole


def test_two_files_give_a_record_a_page_and_a_table(files: tuple[Path, Path], tmp_path: Path) -> None:
    out = tmp_path / "ab"
    line = ["compare", *map(str, files), "--out", str(out)]
    done = CliRunner().invoke(app, line)
    assert done.exit_code == 0, done.output
    assert "rounded.csv against whole.csv:" in done.output
    assert "largest difference [rad]" in done.output
    record = read_result(out)
    assert isinstance(record, CompareRecord)
    assert record.scores.verdict is Verdict.AGREE
    page = (out / "report.html").read_text(encoding="utf-8")
    assert [each.code for each in record.scores.findings[:1]] == ["pair_agrees"]
    for text in (*(each.text for each in record.scores.findings), ENGLISH.label("peak_ratio"), "rotation θ", "slip"):
        assert text in page
    assert "Drawing…" not in page  # the chart has its still picture
    assert (read_history(out / "history_b.csv").theta_rad == doubles.rocking().theta_rad).all()
    # The same again replaces its own files; --json is the same with a page or without.
    again = CliRunner().invoke(app, [*line, "--json"])
    assert json.loads(again.output) == json.loads(CliRunner().invoke(app, [*line[:3], "--json"]).output)


def test_slips_of_centimetres_have_plain_numbers() -> None:
    drawn = svg(compare_figure(("a", "b"), doubles.rocking(slip_m=0.06), doubles.rocking(slip_m=0.03)))
    assert ">60<" in drawn
    assert "e+" not in drawn


def test_a_page_is_refused_where_it_cannot_be(
    files: tuple[Path, Path], tmp_path: Path, root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    taken = tmp_path / "taken"
    taken.mkdir()
    (taken / "mine.txt").write_text("mine")
    for line, said in (
        ([*map(str, files), "--out", str(taken)], "a new or an empty folder"),
        ([str(root / "scenes/free_rocking.toml"), "--out", str(tmp_path / "new")], "two .csv histories"),
    ):
        code = guarded(lambda line=line: app(["compare", *line], standalone_mode=False))
        assert code == WRONG_INPUT
        assert said in capsys.readouterr().err
    assert [path.name for path in taken.iterdir()] == ["mine.txt"]
    assert not (tmp_path / "new").exists()


def test_a_history_that_was_changed_has_no_page(files: tuple[Path, Path], tmp_path: Path) -> None:
    from harness.model import InputError
    from reports.pages.page import write_report

    out = tmp_path / "ab"
    assert CliRunner().invoke(app, ["compare", *map(str, files), "--out", str(out)]).exit_code == 0
    doubles.rest(1.0).write_csv(out / "history_b.csv")
    with pytest.raises(InputError, match=r"history_b\.csv"):
        write_report(out)


def test_a_difference_of_files_that_state_no_error_is_not_said_to_be_the_models(
    files: tuple[Path, Path], tmp_path: Path
) -> None:
    larger = tmp_path / "larger.csv"
    history = doubles.rocking(slip_m=0.0101)
    replace(history, theta_rad=1.05 * history.theta_rad).write_csv(larger)
    done = CliRunner().invoke(app, ["compare", str(files[1]), str(larger), "--out", str(tmp_path / "ab")])
    assert done.exit_code == 0, done.output
    record = read_result(tmp_path / "ab")
    assert isinstance(record, CompareRecord)
    assert record.scores.findings[0].code == "pair_differs_unstated"
