"""The tutorial's commands run as printed, but without the probability, of which it shows no line, and print what stands below
them."""

import os
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reports.cli import app
from tests.reports.shown import not_printed, shown

pytestmark = pytest.mark.slow


def test_a_line_that_is_not_printed_is_told() -> None:
    """In the order of the output; the last column of an engine's row, what it took, may be another."""
    output = "title\n  analytic  stands   5.09°  0.0016 s\nend\n"
    assert not_printed(["title", "  analytic  stands   5.09°  0.0021 s", "end"], output) == []
    assert not_printed(["  analytic  stands   5.10°  0.0016 s"], output) == ["  analytic  stands   5.10°  0.0016 s"]
    assert not_printed(["end", "title"], output) == ["title"]


def test_every_command_of_the_tutorial_works_and_prints_what_is_shown(
    root: Path, data_dir: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROCKCHECK_DATA", str(data_dir.resolve()))
    monkeypatch.chdir(tmp_path)
    found = shown((root / "docs" / "tutorial.md").read_text(encoding="utf-8"))
    assert len(found) >= 7
    assert sum(len(lines) for _, lines in found) >= 15
    for line, lines in found:
        words = shlex.split(os.path.expandvars(line))
        assert words[0] == "rockcheck"
        result = CliRunner().invoke(app, words[1:] + ["--no-assess"] * (words[1] == "run"))
        assert result.exit_code == 0, f"{line}: {result.output}"
        assert not_printed(lines, result.output) == [], f"{line}: {result.output}"
    assert (tmp_path / "out" / "stronger" / "report.html").is_file()
    assert (tmp_path / "out" / "stronger" / "replay.gif").is_file()
    assert len(list((tmp_path / "out" / "stronger" / "figures").iterdir())) == 3
