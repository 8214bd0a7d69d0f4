"""The readme's commands run as printed: studies are only read, runs are cut to a fifth of a second, draws to 100, samples to one,
processes too, and an engine's interval is a wide one."""

import gzip
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from reports.cli import app
from tests.harness.questions.validate.experiments import write_experiments
from tests.meshes import togatus
from tests.reports.shown import not_printed, shown

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parent.parent.parent
RECORD = "records/ce36456p_CE36456.V2.gz"
TOSSES = "tosses/cube_tosses.csv.gz"
SOME_ROWS = 420
"""Of the tosses' table: its header and four tosses."""
DROPS, SOME_DROP_ROWS = "squares/square_drops.csv.gz", 1001
"""Its header and five drops."""


def commands() -> list[str]:
    """Every command of the fenced blocks, once, without its comment and the environment's folder."""
    blocks = re.findall(r"```sh\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.S)
    lines = [
        line.removeprefix(".venv/bin/").partition("#")[0].strip() for block in blocks for line in block.splitlines()
    ]
    return list(dict.fromkeys(line for line in lines if line.startswith("rockcheck ")))


def shortened(line: str) -> list[str]:
    """The words of a command as it is run here."""
    words = shlex.split(line)[1:]
    if words[0] in ("run", "trust", "assess") and "--explain" not in words:
        words += ["--set", "duration_s=0.2"]
    if words[0] == "assess":
        words += ["--draws", "100", "--half-width", "0.4"]
    if words[0] in ("assess", "trust", "validate"):
        words += ["--jobs", "1"]
    if "--samples" in words:
        words[words.index("--samples") + 1] = "1"
    return words


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory, data_dir: Path) -> Path:
    """A folder with the files that the readme names."""
    import trimesh

    folder = tmp_path_factory.mktemp("desk")
    (folder / "scenes").symlink_to(ROOT / "scenes")
    solid = togatus.build()
    trimesh.Trimesh(solid.vertices_m, solid.faces).export(folder / "statue.obj")
    (folder / "quake.V2").write_bytes(gzip.decompress((data_dir / RECORD).read_bytes()))
    t = np.linspace(0.0, 1.0, 101)
    for name, theta in (("mine", np.sin(t)), ("theirs", np.sin(1.01 * t))):
        table = np.column_stack((t, theta))
        np.savetxt(folder / f"{name}.csv", table, delimiter=",", header="t_s,theta_rad", comments="")
    write_experiments(folder, [1.0]).rename(folder / "tests.csv")
    measured = gzip.decompress((data_dir / TOSSES).read_bytes()).splitlines(keepends=True)
    (folder / "tosses.csv.gz").write_bytes(gzip.compress(b"".join(measured[:SOME_ROWS])))
    dropped = gzip.decompress((data_dir / DROPS).read_bytes()).splitlines(keepends=True)
    (folder / "drops.csv.gz").write_bytes(gzip.compress(b"".join(dropped[:SOME_DROP_ROWS])))
    (folder / "ratios.csv").symlink_to((data_dir / "impacts" / "limestone_first_impacts.csv").resolve())
    (folder / "square.toml").symlink_to(ROOT / "scenes" / "square_drop.toml")
    (folder / "cube.toml").symlink_to(ROOT / "scenes" / "cube_toss.toml")
    return folder


def test_the_readme_shows_the_commands_that_are_checked_here() -> None:
    found = commands()
    assert len(found) >= 10
    assert {line.split()[1] for line in found} >= {"run", "compare", "study", "mesh", "new", "motion", "validate"}


@pytest.mark.parametrize("line", commands())
def test_a_command_works_as_printed(desk: Path, data_dir: Path, line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(desk)
    monkeypatch.setenv("ROCKCHECK_DATA", str(data_dir.resolve()))
    words = shortened(line)
    if words[0] == "study":
        from harness.questions.study.cases import load_study

        assert load_study(desk / words[1])
        return
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, f"{line}: {done.output} {done.exception}"
    assert done.output.strip()


def test_the_first_run_is_shown_as_it_is_printed(tmp_path: Path) -> None:
    """The model's part, in a second; `tests/measures/test_documents.py` holds all of it."""
    ((line, lines),) = shown((ROOT / "README.md").read_text(encoding="utf-8"))
    words = shlex.split(line.removeprefix(".venv/bin/"))[1:]
    done = CliRunner().invoke(app, [words[0], str(ROOT / words[1]), "-e", "analytic", "--out", str(tmp_path / "run")])
    (row,) = (each for each in lines if each.split()[0] == "analytic" and "–" not in each)
    assert not_printed([lines[0], row], done.output) == [], done.output
    chance = re.search(r"is \d+ % to \d+ %", " ".join(lines))
    assert chance
    assert chance[0] in " ".join(done.output.split())


def test_the_readme_speaks_of_targets_of_the_makefile() -> None:
    """`make NAME` of the readme, with or without a variable."""
    made = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = set(
        re.findall(r"(?m)(?:^|[`(])make (?:[A-Z]+=[^\s`]+ )?([a-z]+)", (ROOT / "README.md").read_text(encoding="utf-8"))
    )
    assert {"report", "test", "fast", "help"} <= named
    assert [name for name in named if not re.search(rf"^{name}:", made, re.M)] == []
