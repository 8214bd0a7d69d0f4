"""A small map: the command's record and files, checks, and a second call that computes nothing."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from typer.testing import CliRunner

import harness
from harness import engines
from harness.model.errors import InputError
from harness.model.finding import Severity
from harness.records.kinds import read_result
from harness.records.trust import CLASSES, TrustRecord
from harness.runs.runner import InlinePool
from harness.trust import plane, trust_run
from harness.trust.plane import Plane
from harness.trust.point import Said
from harness.trust.trust_run import Map, confirmed_up_to_g, engines_of
from reports.cli import app
from reports.messages import ENGLISH
from reports.pages.page import write_report
from reports.pages.trust_page import map_figure
from reports.terminal import COLUMNS, LINES, trust_lines
from tests.harness.trust.test_plane import BLOCK
from tests.reports import invented_records

KEYS = {"amplitude_g", "frequency_hz", "class", "basis", "amplitude_over_g_tan_alpha", "frequency_over_p"}


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """The file of a scene of which a map has two frequencies and three strengths, computed here."""
    monkeypatch.setattr(plane, "RESOLUTION", {True: 4.5})
    monkeypatch.setattr(plane, "FREQUENCIES", {True: 2})
    monkeypatch.setattr(trust_run, "LocalPool", lambda jobs: InlinePool())
    path = tmp_path / "block.toml"
    path.write_text(tomli_w.dumps({key: value for key, value in BLOCK.items() if key != "uncertainty"}))
    return path


def called(*words: object) -> Any:
    return CliRunner().invoke(app, ["trust", *map(str, words), "--coarse", "-e", "pymunk"])


def test_the_command_writes_a_row_for_each_point_and_goes_on_with_what_it_has(small: Path, tmp_path: Path) -> None:
    out = tmp_path / "map"
    done = called(small, "--out", out)
    assert done.exit_code == 0, done.output
    lines = [line for line in done.stdout.splitlines() if not line.startswith("report: ")]
    assert len(lines) < LINES
    assert max(map(len, lines)) <= COLUMNS
    record = json.loads((out / "result.json").read_text())
    assert record["answer"]["text"]
    cells = record["cells"]
    assert len(cells) == 6
    assert all(cell.keys() >= KEYS and cell["class"] in CLASSES for cell in cells)
    assert sum(record["shares"].values()) == pytest.approx(1.0)
    # The least strength is below the limit of rest, and no engine is needed there but as a check.
    assert [cell["class"] for cell in cells if cell["amplitude_over_g_tan_alpha"] < 1.0] == ["nothing_moves"] * 2
    asked = [cell for cell in cells if cell["basis"] in ("runs", "checked")]
    assert {*asked[0]["outcomes"]} == {"analytic", "pymunk"}
    assert len(asked) == record["summary"]["asked"]
    with (out / "cells.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [row["class"] for row in rows] == [cell["class"] for cell in cells]
    assert 'id="map"' in write_report(out).read_text()
    again = called(small, "--out", out, "--resume", "--json")
    second = json.loads(again.stdout)
    assert second["cells"] == cells
    assert second["summary"]["found"] == record["summary"]["found"] + len(cells) + len(asked)


def test_a_point_says_what_a_run_of_it_says(small: Path, tmp_path: Path) -> None:
    record = trust_run.run_trust(small, tmp_path / "map", ["pymunk"], coarse=True, quiet=True)
    cell = record.cells[-1]
    x = {"kind": "harmonic", "amplitude_g": cell["amplitude_g"], "frequency_hz": cell["frequency_hz"]}
    result = harness.run_scene(harness.load_scene(small).replace({"motion": {"x": x}}), ["analytic", "pymunk"])
    assert cell["answer"] == result.answer().code


@pytest.mark.parametrize(
    ("words", "where"), [(("--motion", "square"), "--motion"), (("--set", "statue.mass_kg=-1"), "--set")]
)
def test_what_is_wrong_is_told_and_nothing_is_written(
    small: Path, tmp_path: Path, words: Sequence[str], where: str
) -> None:
    error = called(small, "--out", tmp_path / "map", *words).exception
    assert isinstance(error, InputError)
    assert error.mistakes[0].where == where
    assert not (tmp_path / "map").exists()


def test_the_model_is_held_against_somebody_and_not_against_its_twin(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = harness.scene({**BLOCK, "uncertainty": {}})
    assert engines_of(scene, None, coarse=False) == ("analytic", "pymunk")
    assert engines_of(scene, ["pymunk"], coarse=False) == ("analytic", "pymunk")
    monkeypatch.setattr(type(engines.load("pybullet")), "missing", lambda engine: "not installed here")
    for names in (["analytic"], ["pymunk", "pybullet"]):
        with pytest.raises(InputError) as caught:
            engines_of(scene, names, coarse=False)
        assert caught.value.mistakes[0].where == "--engine"


def test_a_shaking_across_the_plane_is_asked_of_space_even_on_a_coarse_map() -> None:
    across = {**BLOCK["motion"], "y": {"kind": "harmonic", "amplitude_g": 0.1, "frequency_hz": 2.0}}
    scene = harness.scene({**BLOCK, "motion": across, "uncertainty": {}})
    for motion, wanted in (("scene", ("analytic", "pymunk", "spatial")), ("sine", ("analytic", "pymunk"))):
        whole = Plane.of(scene, motion, coarse=True)
        assert engines_of(whole.at(whole.points[-1]), None, coarse=True) == wanted


def word(kind: str, *, still: bool = False, apart_rad: float = 0.0) -> Said:
    return Said(kind, "agree", [], {"analytic": "stands"}, still, False, "", 0.1, apart_rad, 1.0, 1.0, True)  # type: ignore[arg-type]


def found(kinds: dict[int, str], rest: int = 0) -> Map:
    """Nine strengths at one frequency that the model says alike, the least of them at rest; what engines said at some."""
    whole = Plane(None, None, "sine", [0.1 * 1.05**j for j in range(9)], [1.0])  # type: ignore[arg-type]
    model = {(0, j): word("no_answer", still=j < rest) for j in range(9)}
    return Map(whole, model, {(0, j) for j in range(rest)}, {(0, j): word(kind) for j, kind in kinds.items()})


def test_between_points_that_agree_the_class_is_theirs() -> None:
    known = found({2: "confirmed", 8: "confirmed"}, rest=2)
    assert [known.kind((0, j))[:2] for j in (0, 2, 5)] == [
        ("nothing_moves", "rest"), ("confirmed", "runs"), ("confirmed", "between"),
    ]  # fmt: skip
    assert not known.unasked()


def test_a_check_that_agrees_changes_nothing_and_another_class_is_refined() -> None:
    known = found({2: "confirmed", 8: "confirmed"}, rest=2)
    known.check([(0, 5)], {(0, 5): word("confirmed")})
    assert not known.changed
    assert known.kind((0, 5))[1] == "checked"
    known.check([(0, 1)], {(0, 1): word("refuted")})
    assert known.changed == {(0, 1)}
    # Nor do the limits of rest decide along that frequency any longer.
    assert known.unasked() == {(0, 0)}


def test_the_strength_up_to_which_a_model_holds_ends_at_the_first_doubt() -> None:
    known = found({0: "confirmed", 4: "outcome_confirmed", 5: "probability", 6: "confirmed", 8: "confirmed"})
    assert confirmed_up_to_g(known) == pytest.approx(0.1 * 1.05**4)
    known.ran[0, 4] = word("outcome_confirmed", apart_rad=0.5)
    assert confirmed_up_to_g(known) == pytest.approx(0.1 * 1.05**3)
    known.ran[0, 0] = word("refuted")
    assert confirmed_up_to_g(known) is None


def test_the_map_s_picture_has_a_colour_and_a_name_for_each_class(small: Path, tmp_path: Path) -> None:
    folder = tmp_path / "map"
    called(small, "--out", folder, "--motion", "scene", "--json")
    record = read_result(folder)
    assert isinstance(record, TrustRecord)
    assert {cell["frequency_hz"] for cell in record.cells} == {None}
    drawn = map_figure(record)
    heat, *named = drawn["data"]
    assert [[CLASSES[code] for code in row] for row in heat["z"]] == [[cell["class"]] for cell in record.cells]
    assert len(named) - 1 == len({cell["class"] for cell in record.cells})
    changed = replace(record, shares={**record.shares, "refuted": 0.5})
    assert len(map_figure(changed)["data"]) == len(drawn["data"]) + 1


def test_a_map_of_every_class_fits_the_terminal_and_its_page_names_each(tmp_path: Path) -> None:
    record = invented_records.trust().texted(ENGLISH.say)
    lines = trust_lines(record)
    assert len(lines) < LINES
    assert max(map(len, lines)) <= COLUMNS
    assert record.answer is not None
    assert record.answer.code == "refuted"
    assert record.answer.findings[0].severity is Severity.CHANGES_ANSWER
    html = write_report(invented_records.write_trust(tmp_path / "map")).read_text()
    assert 'class="verdict failed"' in html
    assert all(f"<dt>{ENGLISH.word(kind)}, {ENGLISH.percent(0.125)}</dt>" in html for kind in CLASSES)
