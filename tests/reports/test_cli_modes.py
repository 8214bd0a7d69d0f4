"""Commands that look at files and write some: `--json` gives a record and nothing else, `--quiet` nothing."""

import json
import shlex
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from typer.main import get_command
from typer.testing import CliRunner

from reports.cli import app
from reports.cli.app import EngineOptions, OutputOptions, spread
from reports.terminal import COLUMNS, LINES
from tests.meshes import toadstool

COMMANDS = {
    "inspect": ("mesh inspect statue.ply --unit m --up z", ""),
    "prepare": ("mesh prepare statue.ply --unit m --up z --out new.ply", "new.ply"),
    "new": ("new statue.ply --unit m --up z --motion quake.csv --out new.toml", "new.toml"),
}


@pytest.fixture(scope="module")
def statue(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A body of two parts whose surface passes through itself at one vertex: its parts are joined, and the vertex is told."""
    path = tmp_path_factory.mktemp("statue") / "statue.ply"
    body = trimesh.Trimesh(*toadstool.surface(), process=False).subdivide().subdivide()
    through = np.argmin(np.linalg.norm(body.vertices - [0.5, 0.0, toadstool.HEIGHT_M], axis=1))
    body.vertices[through, 2] = toadstool.UNDERSIDE_M - 0.05
    part = trimesh.creation.box((0.2, 0.2, 0.2), trimesh.transformations.translation_matrix((-0.5, 0.0, 0.7)))
    trimesh.util.concatenate([body, part]).export(path)
    return path.read_bytes()


@pytest.fixture
def folder(statue: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "statue.ply").write_bytes(statue)
    (tmp_path / "quake.csv").write_text("t_s,a_0_ms2\n0,0\n0.5,1\n1,0\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_command_has_both_modes() -> None:
    def lacking(group: Any) -> list[str]:
        found = []
        for name, command in group.commands.items():
            known = {option for item in command.params for option in item.opts}
            # A list of engines, or a schema, is all that these have to say.
            wanted = {"engines": {"--json"}, "schema": set()}.get(name, {"--json", "--quiet"})
            found += lacking(command) if hasattr(command, "commands") else [name] * (not wanted <= known)
        return found

    assert lacking(get_command(app)) == []


@pytest.mark.parametrize("name", COMMANDS)
def test_quiet_writes_the_file_and_says_nothing(folder: Path, name: str) -> None:
    line, file = COMMANDS[name]
    done = CliRunner().invoke(app, [*line.split(), "--quiet"])
    assert (done.exit_code, done.output) == (0, "")
    assert (folder / file).exists()


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("inspect", {"refusal": None}),
        ("prepare", {"refusal": None}),
        ("new", {"scene": "new.toml"}),
    ],
)
def test_json_is_a_record_and_nothing_else(folder: Path, name: str, wanted: dict[str, Any]) -> None:
    line, file = COMMANDS[name]
    done = CliRunner().invoke(app, [*line.split(), "--json"])
    assert done.exit_code == 0, done.output
    found = json.loads(done.output)
    assert {key: found[key] for key in wanted} == wanted
    assert (folder / file).exists()


def test_the_command_that_runs_a_new_scene_is_one_that_a_shell_takes(folder: Path) -> None:
    line = COMMANDS["new"][0].split()
    done = CliRunner().invoke(app, [*line[:-1], "my first.toml"])
    command = done.output.splitlines()[-1].partition(": ")[2]
    assert shlex.split(command) == ["rockcheck", "run", "my first.toml"]
    assert (folder / "my first.toml").exists()


@pytest.mark.parametrize("name", ["inspect", "new"])
def test_it_fits_a_terminal_and_all_is_told_where_asked(folder: Path, name: str) -> None:
    def printed(*more: str) -> str:
        for made in folder.glob("new*"):
            made.unlink()
        return CliRunner().invoke(app, [*COMMANDS[name][0].split(), *more]).output

    short = printed().splitlines()
    assert len(short) <= LINES
    assert max(map(len, short)) <= COLUMNS
    findings, whole = json.loads(printed("--json"))["findings"], " ".join(printed("--verbose").split())
    assert findings
    assert all(" ".join(each["text"].split()) in whole for each in findings)


def test_the_version_is_said() -> None:
    done = CliRunner().invoke(app, ["--version"])
    assert (done.exit_code, done.output) == (0, f"rockcheck {version('rockcheck')}\n")


def test_a_shell_can_be_taught_to_complete() -> None:
    known = {option for item in get_command(app).params for option in item.opts}
    assert {"--install-completion", "--show-completion"} <= known


def test_a_records_unit_is_named_alike() -> None:
    """`--motion-unit` says a record's unit wherever one is read; a group's options stand in every command that takes it."""
    commands: dict[str, Any] = vars(get_command(app))["commands"]
    new, inspect = commands["new"], commands["motion"].commands["inspect"]
    for item in (new, inspect):
        assert "--motion-unit" in {option for parameter in item.params for option in parameter.opts}


def test_a_group_of_options_reaches_its_function() -> None:
    got: list[Any] = []

    def function(first: int, asked: EngineOptions, saying: OutputOptions, last: str = "x") -> None:
        """Say it."""
        got.append((first, asked, saying, last))

    spread(function)(first=1, engine=["a"], overrides=None, as_json=True, quiet=False, verbose=False, last="y")
    assert got == [(1, EngineOptions(["a"], None), OutputOptions(as_json=True), "y")]
    assert spread(function).__doc__ == "Say it."
