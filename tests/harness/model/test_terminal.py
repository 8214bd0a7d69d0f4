"""A user's own text can neither steer a terminal nor end rich's markup, wherever it is said."""

import errno
import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from harness import load_scene, run_scene
from harness.model import CONTROL, InputError, Mistake, json_text, printable, printable_lines
from harness.runs.progress import ProgressMessages, progress
from reports.cli import app
from reports.cli.app import guarded
from reports.messages import ENGLISH
from reports.terminal import record_lines
from tests.reports.claim_scenes import HOSTILE, content, write_scene


def test_controls_are_told_as_their_escapes() -> None:
    assert printable("a\x1b[31m\nb\x9b\u202e\udcff") == r"a\x1b[31m\nb\x9b\u202e\udcff"
    assert printable_lines("a\x1b\nb") == "a\\x1b\nb"
    assert printable("Grüße, θ − 1 … “ok” 日本") == "Grüße, θ − 1 … “ok” 日本"


def test_json_stays_json_and_carries_no_control() -> None:
    value = {"title": HOSTILE + "\x9b\x7f\udcff", "list": [1, 2.5, None]}
    text = json_text(value)
    assert json.loads(text) == value
    assert not CONTROL.search(text.replace("\n", ""))


def test_what_is_told_at_work_takes_any_name(capsys: pytest.CaptureFixture[str]) -> None:
    with ProgressMessages(quiet=False) as telling:
        telling.now(f"running {HOSTILE} [bold]b[/bold]")
    with progress(HOSTILE, quiet=False, size=HOSTILE) as told:
        told(0, 2)
        told(2, 2)
    said = capsys.readouterr().err
    assert not CONTROL.search(said.replace("\n", ""))
    assert r"x [/] y" in said
    assert "[bold]b[/bold]" in said
    assert said.count(r"\x1b[31m\nred") >= 4


def test_a_title_is_one_line(tmp_path: Path) -> None:
    scene = load_scene(write_scene(tmp_path, content(0)))
    record = run_scene(scene, ["analytic"]).record().texted(ENGLISH.say)
    first = record_lines(record)[0]
    assert first.removesuffix("…") == printable(HOSTILE)[: len(first) - first.endswith("…")]


def test_mistakes_and_names_of_files_are_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    def action() -> int:
        raise InputError(Mistake(f"{HOSTILE}.toml", "", "a file", "none\x07"))

    assert guarded(action) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert not CONTROL.search(said.replace("\n", ""))


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (OSError("no library of that name"), "error: no library of that name\n"),
        (OSError(errno.ENOSPC, "No space"), "error: the output could not be written: No space\n"),
        (OSError(errno.ENOSPC, "No space", "a"), "error: 'a' could not be read or written: No space\n"),
    ],
)
def test_what_the_system_refuses_is_no_mistake_of_the_inputs(
    fault: OSError, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    def action() -> int:
        raise fault

    assert guarded(action) == 1
    assert capsys.readouterr().err == said


@pytest.mark.parametrize("options", [[], ["--json"], ["--explain"]])
def test_the_command_runs_a_scene_of_such_a_title(tmp_path: Path, options: list[str]) -> None:
    scene = write_scene(tmp_path, content(0))
    result = CliRunner().invoke(app, ["run", str(scene), "-e", "analytic", "--out", str(tmp_path / "out"), *options])
    assert result.exit_code == 0, result.output
    assert not CONTROL.search(result.output.replace("\n", ""))
