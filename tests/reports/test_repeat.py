"""The command with which a page says that its result is repeated has what was asked of it."""

import re
import shlex
from html import unescape
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reports.cli import app
from tests import doubles

BLOCK = """title = "Block"
duration_s = 0.3
[statue]
mass_kg = 100.0
centroid_height_m = 0.5
corner_left_m = 0.1
corner_right_m = 0.1
inertia_kg_m2 = 8.7
height_m = 1.0
depth_m = 0.4
[motion.x]
kind = "harmonic"
amplitude_g = 0.25
frequency_hz = 2.0
"""
STUDY = """title = "Blocks"
scene = "block.toml"
[[vary]]
key = "motion.x.amplitude_g"
values = [0.1, 0.25]
[[variant]]
name = "block"
engines = ["analytic"]
"""
ASKED = {
    "run block.toml": "-e analytic --accuracy 1e-05 --no-skip mirror --no-skip quiet_end --no-assess",
    "compare a.csv b.csv": "--uncertainty 0.0 --measured-uncertainty 0.002 --input-uncertainty 0.001 --slip-uncertainty 0.1",
    "assess block.toml": "-e pymunk --draws 20 --half-width 0.1 --most-runs 40 --seed 3 --no-options",
    "study study.toml": "--large",
}


@pytest.mark.parametrize("command", ASKED)
def test_a_page_s_command_asks_what_was_asked(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "block.toml").write_text(BLOCK)
    (tmp_path / "study.toml").write_text(STUDY)
    for name in ("a.csv", "b.csv"):
        doubles.rocking().write_csv(tmp_path / name)
    monkeypatch.chdir(tmp_path)
    asked = shlex.split(ASKED[command])
    done = CliRunner().invoke(app, [*command.split(), *asked, "--quiet", "--out", "out"])
    assert done.exit_code == 0, done.output
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    told = re.search(rf"rockcheck {command.split()[0]} [^<\n]*", page)
    assert told is not None
    words = shlex.split(unescape(told.group()))
    assert sorted(set(asked) - set(words)) == []
    words = [word for word in words[1:] if word not in ("--out", "out")]
    assert CliRunner().invoke(app, [*words, "--quiet", "--out", "again"]).exit_code == 0
