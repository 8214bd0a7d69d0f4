"""A record changed by hand is told by file and key, with exit code 2 and no traceback; a page's own fault is seen as one."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from reports.cli import app
from reports.cli.app import WRONG_INPUT, guarded
from reports.pages import run_page
from reports.pages.page import write_report
from reports.source import run_source
from tests.reports.invented_run import write_invented

Edit = Callable[[dict[str, Any]], Any]


def without(*path: str) -> Edit:
    def edit(record: dict[str, Any]) -> None:
        for key in path[:-1]:
            record = record[key]
        del record[path[-1]]

    return edit


def put(value: Any, *path: str) -> Edit:
    def edit(record: dict[str, Any]) -> None:
        for key in path[:-1]:
            record = record[key]
        record[path[-1]] = value

    return edit


DAMAGE: dict[str, tuple[Edit, str]] = {
    "no title": (without("title"), "title"),
    "a scene as a number": (put(3, "scene"), "scene"),
    "no machine": (without("machine"), "machine"),
    "no runs": (without("runs"), "runs"),
    "runs as a list": (put([], "runs"), "runs"),
    "a run as a number": (put(3, "runs", "pymunk"), "runs.pymunk"),
    "no outcome": (without("runs", "pymunk", "outcome"), "runs.pymunk.outcome"),
    "an unknown outcome": (put("flies", "runs", "pymunk", "outcome"), "runs.pymunk.outcome"),
    "a number as text": (put("0.1", "runs", "pymunk", "peak_theta_rad"), "runs.pymunk.peak_theta_rad"),
    "a flag as a number": (put(True, "runs", "pymunk", "steps"), "runs.pymunk.steps"),
    "an unknown pattern": (put([[0.0, 1.0, "dancing"]], "runs", "pymunk", "patterns"), "runs.pymunk.patterns.0.2"),
    "a stretch too short": (put([[0.0]], "runs", "pymunk", "patterns"), "runs.pymunk.patterns.0.1"),
    "no statue": (without("scene", "statue"), "scene.statue"),
    "a null mass": (put(None, "scene", "statue", "mass_kg"), "scene.statue.mass_kg"),
    "a flat point": (put([[0.0], [1.0], [2.0]], "scene", "statue", "section_m"), "scene.statue.section_m.0.1"),
    "no base": (put([], "scene", "statue", "footprint_m"), "scene.statue.footprint_m"),
    "a height of nothing": (put(0.0, "scene", "statue", "centroid_height_m"), "scene.statue.centroid_height_m"),
    "a wall in the middle": (put("middle", "scene", "wall", "side"), "scene.wall.side"),
    "a motion cut short": (put([0.0, 1.0], "motion", "x_m_s2"), "motion.x_m_s2"),
    "a cause of its own": (put("wind", "motion", "push", "first"), "motion.push.first"),
    "scores as text": (put("good", "scores", "analytic_vs_pymunk"), "scores.analytic_vs_pymunk"),
    "no verdict": (without("scores", "analytic_vs_pymunk", "verdict"), "scores.analytic_vs_pymunk.verdict"),
    "a history of nobody": (put(["analytic", "nobody"], "histories"), "histories"),
    "the plan as a table": (put({}, "plan"), "plan"),
    "a pattern as text": (put(["sine"], "runs", "pymunk", "patterns"), "runs.pymunk.patterns.0"),
    "a version as a number": (put(1, "versions", "numpy"), "versions.numpy"),
}


@pytest.fixture
def whole(written: Callable[[str], Path]) -> Path:
    return written("agreed")


@pytest.mark.parametrize("command", ["report", "figures", "gif"])
@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_told_by_file_and_key(
    tmp_path: Path, whole: Path, capsys: pytest.CaptureFixture[str], command: str, damage: str
) -> None:
    folder = tmp_path / "out"
    shutil.copytree(whole, folder)
    edit, key = DAMAGE[damage]
    record = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    edit(record)
    (folder / "result.json").write_text(json.dumps(record), encoding="utf-8")
    before = sorted(folder.iterdir())
    assert guarded(lambda: app([command, str(folder)], standalone_mode=False)) == WRONG_INPUT
    said = capsys.readouterr().err
    assert f"{folder / 'result.json'}: {key}: wanted " in said
    assert "Input should" not in said
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "null", "1", '"run"', '{"schema_version": 1, "kind": "run"}', "[" * 9999]
)
def test_what_is_no_record_is_told_by_its_file(tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str) -> None:
    (tmp_path / "result.json").write_text(text, encoding="utf-8")
    assert guarded(lambda: app(["report", str(tmp_path)], standalone_mode=False)) == WRONG_INPUT
    assert f"{tmp_path / 'result.json'}: " in capsys.readouterr().err


def changed(whole: Path, into: Path, **keys: object) -> Path:
    """A copy of a result whose record says something else."""
    folder = into / "out"
    shutil.copytree(whole, folder)
    record = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    (folder / "result.json").write_text(json.dumps(record | keys), encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    "damage", [{"code": "no_such"}, {"code": "error_not_bounded", "values": {"until_s": "x", "end_s": 1.0}}]
)
def test_a_finding_that_makes_no_sentence_is_damage(
    tmp_path: Path, whole: Path, capsys: pytest.CaptureFixture[str], damage: dict[str, Any]
) -> None:
    folder = changed(whole, tmp_path, findings=[{"severity": "info", "engine": "", "values": {}, "text": "", **damage}])
    assert guarded(lambda: app(["report", str(folder)], standalone_mode=False)) == WRONG_INPUT
    assert f"{folder / 'result.json'}: findings" in capsys.readouterr().err


def test_an_answer_of_no_sentence_is_headed_by_its_title(tmp_path: Path, whole: Path) -> None:
    folder = changed(whole, tmp_path, answer={"code": "one_model", "findings": [], "text": ""})
    assert write_report(folder) == folder / "report.html"


def test_a_pages_own_fault_is_no_damage(tmp_path: Path, whole: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise KeyError("a fault of the page")

    folder = tmp_path / "out"
    shutil.copytree(whole, folder)
    monkeypatch.setattr(run_page, "chip", broken)
    with pytest.raises(KeyError, match="a fault of the page"):
        write_report(folder)


def test_a_mesh_beside_a_statue_of_numbers_is_another_s(tmp_path: Path) -> None:
    write_invented(tmp_path)
    (tmp_path / "statue.glb").write_bytes(b"no mesh")
    assert run_source(tmp_path).mesh is None
