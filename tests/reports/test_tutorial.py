"""The tutorial's commands run as printed."""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reports.cli import app

pytestmark = pytest.mark.slow


def commands(page: Path) -> list[list[str]]:
    blocks = re.findall(r"```console\n(.*?)```", page.read_text(encoding="utf-8"), re.S)
    lines = [line[2:] for block in blocks for line in block.splitlines() if line.startswith("$ ")]
    return [shlex.split(os.path.expandvars(line)) for line in lines]


def test_every_command_of_the_tutorial_works(
    root: Path, data_dir: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROCKCHECK_DATA", str(data_dir.resolve()))
    monkeypatch.chdir(tmp_path)
    found = commands(root / "docs" / "tutorial.md")
    assert len(found) >= 7
    for words in found:
        assert words[0] == "rockcheck"
        result = CliRunner().invoke(app, words[1:])
        assert result.exit_code == 0, f"{' '.join(words)}: {result.output}"
    assert (tmp_path / "out" / "stronger" / "report.html").is_file()
    assert (tmp_path / "out" / "stronger" / "replay.gif").is_file()
    assert len(list((tmp_path / "out" / "stronger" / "figures").iterdir())) == 3
