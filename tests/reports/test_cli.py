"""The command as a person meets it: exit codes, messages without tracebacks, nothing half-written."""

import json
import os
import re
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

from harness import InputError, Run
from harness.engines.base import Engine
from harness.questions.scene import scene_run
from harness.runs.execute import KEPT, Campaign
from harness.runs.progress import LESS_STORED
from harness.runs.runner import InlinePool
from reports.cli import app, studies
from reports.cli.app import INTERRUPTED, guarded
from reports.pages.page import write_report
from reports.terminal import COLUMNS
from tests.command import rockcheck
from tests.fuzz.originals import RATIOS
from tests.reports.invented_run import write_invented

SCENE = """
title = "a block"
duration_s = 1.0
[statue]
mass_kg = 100.0
centroid_height_m = 0.5
corner_left_m = 0.1
corner_right_m = 0.1
inertia_kg_m2 = 8.666666666666666
[initial]
theta_rad = 0.05
"""


IN_A_PROCESS = [sys.executable, "-c", "from reports.cli import main; main()"]


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "block.toml"
    path.write_text(SCENE)
    return path


def test_a_model_that_refuses_a_scene_agrees_with_nobody(scene: Path, tmp_path: Path) -> None:
    scene.write_text(SCENE.replace("[initial]", "height_m = 1.0\n[contact]\nrestitution = 0.9\n[initial]"))
    done = rockcheck("run", "block.toml", "-e", "analytic", "-e", "spatial", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    record = json.loads((tmp_path / "out" / "block" / "result.json").read_text())
    assert record["answer"]["code"] == "one_model"
    assert record["runs"]["spatial"]["outcome"] == "crashed"
    assert "agree" not in done.stdout
    assert "crashed" not in done.stdout


def test_a_run_writes_its_histories_record_and_page(scene: Path, tmp_path: Path) -> None:
    done = rockcheck("run", "block.toml", "-e", "analytic", "-e", "pymunk", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    folder = tmp_path / "out" / "block"
    names = {path.name for path in folder.iterdir()}
    assert names == {"result.json", "report.html", "conservator.html", "history_analytic.csv", "history_pymunk.csv"}
    record = json.loads((folder / "result.json").read_text())
    assert record["answer"]["code"] == "agree"
    assert record["schema_version"] == 1
    assert set(record["runs"]) == {"analytic", "pymunk"}
    assert "analytic_vs_pymunk" in record["scores"]
    assert record["witness"] == {}
    header = (folder / "history_analytic.csv").read_text().splitlines()[0]
    assert header.startswith("t_s,theta_rad,theta_rate_rad_s,slip_m,slip_rate_m_s")


def test_unmodified_engines_are_run_where_they_are_asked_for(scene: Path, tmp_path: Path) -> None:
    done = rockcheck("run", "block.toml", "-e", "pymunk", "--witness", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "out" / "block" / "result.json").read_text())
    assert set(record["witness"]) == {"pymunk:plain"}
    assert record["witness"]["pymunk:plain"]["runs"]["pymunk"]["agrees"]


def test_without_pybullet_everything_else_runs_and_says_so(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pybullet", None)
    for named, code in (((), 0), (("-e", "analytic", "-e", "pybullet"), 1)):
        done = rockcheck("run", "block.toml", *named, "--out", f"out{code}", cwd=tmp_path)
        assert done.returncode == code, done.stderr
        assert "pybullet " in done.stdout
        assert (tmp_path / f"out{code}" / "report.html").is_file()
        record = json.loads((tmp_path / f"out{code}" / "result.json").read_text())
        assert record["runs"]["pybullet"]["outcome"] == "unavailable"
        assert record["runs"]["analytic"]["outcome"] == "stands"
    listed = json.loads(rockcheck("engines", "--json", cwd=tmp_path).stdout)
    missing = {row["engine"]: row["missing"] for row in listed}
    assert missing["pymunk"] is None
    assert "pybullet " in missing["pybullet"]


def test_where_no_contact_engine_was_ever_imported_the_model_runs_alone(scene: Path, tmp_path: Path) -> None:
    code = (
        "import sys; sys.modules['pymunk'] = sys.modules['pybullet'] = None; from reports.cli import app, main\n"
        "app(['engines'], standalone_mode=False); main()"
    )
    command = [sys.executable, "-c", code, "run", "block.toml"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    listed, run = done.stdout.split("a block")
    assert "pymunk " in listed
    assert "pymunk " in run
    folder = tmp_path / "out" / "block"
    assert json.loads((folder / "result.json").read_text())["answer"]["code"] == "one_model"
    assert (folder / "report.html").is_file()


def test_json_mode_prints_the_record_and_nothing_else(scene: Path, tmp_path: Path) -> None:
    done = rockcheck("run", "block.toml", "-e", "analytic", "--json", cwd=tmp_path)
    assert json.loads(done.stdout)["runs"]["analytic"]["outcome"] == "stands"
    assert done.stderr == ""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "none.toml"], "none.toml"),
        (["run", "block.toml", "-e", "pybulet"], " pybullet?"),
        (["run", "block.toml", "--set", "statue.mass_kg=-1"], "statue.mass_kg"),
        (["run", "block.toml", "--set", "statue.corner_right_m=-0.01"], "statue.corner_right_m"),
        (["run", "block.toml", "--accuracy", "1e-3", "--dt", "1e-3"], "--accuracy and --dt: "),
        (["run", "block.toml", "--dt", "0"], "--dt"),
        (["run", "block.toml", "--explain", "--accuracy", "nan"], "--accuracy"),
        (["run", "block.toml", "--explain", "--accuracy", "1e-3", "--dt", "1e-3"], "--accuracy and --dt: "),
        (["run", "block.toml", "--set", "statue.mass_kg=" + "[" * 5000], "nested too deeply"),
        (["run", "block.toml", "-e", "analytic", "--out", "/proc/nowhere"], "--out"),
        (["compare", "a.csv", "b.csv", "-e", "pymunk"], "nothing is run"),
        (["run", "block.toml", "--no-skip", "quiet_strat"], " quiet_start?"),
        (["run", "block.toml", "--out", "block.toml"], "a folder"),
        (["compare", "a.csv"], "exactly two"),
        (["compare", "a.csv", "b.csv"], "a.csv"),
        (["study", "block.toml"], "`rockcheck run block.toml`"),
        (["report", "nowhere"], "nowhere"),
        (["mesh", "inspect", "none.obj"], "none.obj"),
        (["motion", "inspect", "none.V2"], "none.V2"),
        (["motion", "inspect", "block.toml"], "it has none"),
        (["new", "none.obj", "--motion", "none.csv"], "none"),
        (["validate", "none.csv"], "none.csv"),
        (["frobnicate"], "frobnicate"),
    ],
)
def test_a_mistake_is_told_without_traceback_and_writes_nothing(
    scene: Path, tmp_path: Path, arguments: list[str], message: str
) -> None:
    before = sorted(path.name for path in tmp_path.rglob("*"))
    done = rockcheck(*arguments, cwd=tmp_path)
    assert done.returncode == 2, (done.stdout, done.stderr)
    assert message in done.stderr
    assert sorted(path.name for path in tmp_path.rglob("*")) == before


def test_explain_lists_the_skips_and_runs_nothing(scene: Path, tmp_path: Path) -> None:
    done = rockcheck("run", "block.toml", "--explain", cwd=tmp_path)
    assert done.returncode == 0
    assert "quiet_start" in done.stdout
    assert "base_only (pybullet)" in done.stdout
    assert not (tmp_path / "out").exists()


def test_explain_in_json_is_json_and_quietly_says_nothing(scene: Path, tmp_path: Path) -> None:
    done = rockcheck("run", "block.toml", "--explain", "--json", cwd=tmp_path)
    assert "quiet_start" in {step["skip"] for step in json.loads(done.stdout)}
    assert rockcheck("run", "block.toml", "--explain", "-q", cwd=tmp_path).stdout == ""


def test_a_value_nested_beyond_reading_is_a_mistake(tmp_path: Path) -> None:
    (tmp_path / "deep.toml").write_text("a = " + "[" * 5000 + "]" * 5000)
    for command in ("run", "study"):
        done = rockcheck(command, "deep.toml", cwd=tmp_path)
        assert (done.returncode, "nested too deeply" in done.stderr) == (2, True), done.stderr


@pytest.mark.parametrize(("key", "scene_file"), [("initial.theta", "block.toml"), ("initial.theta_rad", "none.toml")])
def test_a_wrong_study_leaves_no_store(scene: Path, tmp_path: Path, key: str, scene_file: str) -> None:
    text = f'title = "s"\nscene = "{scene_file}"\n[[vary]]\nkey = "{key}"\nvalues = [0.05]\n'
    (tmp_path / "wrong.toml").write_text(text + '[[variant]]\nname = "a"\nengines = ["analytic"]\n')
    done = rockcheck("study", "wrong.toml", "--out", "made/here", cwd=tmp_path)
    assert done.returncode == 2, done.stderr
    assert not (tmp_path / "made").exists()


def test_a_study_s_forecast_leaves_out_what_its_store_holds(
    scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = f'title = "s"\nscene = "{scene.name}"\n[[vary]]\nkey = "initial.theta_rad"\nvalues = [0.05]\n'
    study = scene.with_name("one.toml")
    study.write_text(text + '[[variant]]\nname = "a"\nengines = ["analytic"]\n')
    for less in (False, True):
        studies.run(study, tmp_path / "out", pool=InlinePool())
        first, *_ = capsys.readouterr().err.splitlines()
        assert first.startswith("1 case, 1 run: about ")
        assert first.endswith(LESS_STORED) is less


def test_an_interrupt_is_told_with_the_command_that_goes_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["/bin/rockcheck", "study", "my study.toml", "--jobs", "2"])

    def interrupted(*given: object) -> None:
        raise KeyboardInterrupt

    def of_a_campaign() -> None:
        campaign = Campaign(Mock(keys=set), Mock(workers=1, run=interrupted))
        try:
            campaign.run([], 1)
        except KeyboardInterrupt as ending:  # as typer does
            raise SystemExit(INTERRUPTED) from ending

    for ended, kept in ((interrupted, False), (of_a_campaign, True)):
        assert guarded(ended) == INTERRUPTED
        said = capsys.readouterr().err
        assert "rockcheck study 'my study.toml' --jobs 2" in said
        assert (KEPT in said) == kept
    with pytest.raises(SystemExit):
        guarded(lambda: sys.exit(1))


def test_a_history_that_is_gone_is_told_by_its_file(tmp_path: Path) -> None:
    write_invented(tmp_path, mesh=True)
    for name in ("history_pymunk.csv", "statue.glb"):
        (tmp_path / name).rename(tmp_path / "aside")
        with pytest.raises(InputError, match=f"{name}: .* result.json"):
            write_report(tmp_path)
        (tmp_path / "aside").rename(tmp_path / name)
    write_report(tmp_path)


def every_command() -> list[tuple[str, Any]]:
    from typer.main import get_command

    def within(group: Any, words: str) -> Iterator[tuple[str, Any]]:
        for name, command in group.commands.items():
            yield from within(command, f"{words}{name} ") if hasattr(command, "commands") else [(words + name, command)]

    return list(within(get_command(app), ""))


@pytest.mark.parametrize(("name", "command"), every_command(), ids=lambda item: item if isinstance(item, str) else "")
def test_every_commands_help_has_examples_of_files_that_exist(root: Path, name: str, command: Any) -> None:
    examples = re.findall(r"`(rockcheck [^`]+)`", command.epilog or "")
    assert examples, "no example"
    known = {option for item in command.params for option in item.opts}
    for example in examples:
        words = shlex.split(example)[1:]
        assert " ".join(words).startswith(f"{name} ") or words == [name]
        assert [word for word in words if word.startswith("-") and word not in known] == []
        assert [word for word in words if word.startswith("scenes/") and not (root / word).is_file()] == []


@pytest.mark.parametrize("reader", ["engineer", "conservator"])
def test_the_page_of_a_reader_is_named(tmp_path: Path, reader: str) -> None:
    write_invented(tmp_path)
    done = rockcheck("report", ".", "--for", reader, cwd=tmp_path)
    name = {"engineer": "report.html", "conservator": "conservator.html"}[reader]
    assert (done.returncode, done.stdout) == (0, f"report: {name}\n"), done.stderr
    assert rockcheck("report", ".", "--for", "tourist", cwd=tmp_path).returncode == 2


def test_a_reader_without_a_page_is_told_before_any_page_is_written(tmp_path: Path) -> None:
    (tmp_path / "ratios.csv").write_bytes(RATIOS)
    assert rockcheck("validate", "ratios.csv", "--out", "out", "--json", cwd=tmp_path).returncode == 0
    done = rockcheck("report", "out", "--for", "conservator", cwd=tmp_path)
    assert (done.returncode, "--for" in done.stderr) == (2, True)
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["result.json"]


def test_quiet_is_quiet_with_every_engine(scene: Path, tmp_path: Path) -> None:
    """In a process of its own: pybullet itself prints a line as it is imported."""
    pytest.importorskip("pybullet")
    command = [*IN_A_PROCESS, "run", "block.toml", "-e", "pybullet", "-q", "--set", "duration_s=0.05"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_a_command_whose_standard_streams_are_closed_writes_its_result(scene: Path, tmp_path: Path) -> None:
    done = in_a_shell("rockcheck run block.toml -e analytic --set duration_s=0.05 <&- >&- 2>&-", tmp_path)
    assert done.returncode == 0
    assert (tmp_path / "out" / "block" / "conservator.html").is_file()
    wrong = in_a_shell("rockcheck run other.toml 2>&-", tmp_path)
    assert (wrong.returncode, wrong.stdout) == (2, "")


def test_two_histories_of_any_software_are_compared(scene: Path, tmp_path: Path) -> None:
    rockcheck("run", "block.toml", "-e", "analytic", "-q", cwd=tmp_path)
    table = str(tmp_path / "out" / "block" / "history_analytic.csv")
    done = rockcheck("compare", table, table, "--json", cwd=tmp_path)
    scores = json.loads(done.stdout)["history_analytic.csv_vs_history_analytic.csv"]
    assert scores["rms_theta_rad"] == 0.0
    told = rockcheck("compare", table, table, "--uncertainty", "1e-12", cwd=tmp_path).stdout.splitlines()
    assert max(map(len, told)) <= COLUMNS


def test_two_models_are_compared_over_a_suite_of_scenes(scene: Path, tmp_path: Path) -> None:
    """Nine scenes of one block let go from unlike leans: outcomes and the distributions of the maxima, after the pairs."""
    text = (tmp_path / "block.toml").read_text(encoding="utf-8")
    names = []
    for k in range(9):
        names.append(f"s{k}.toml")
        (tmp_path / names[-1]).write_text(
            text.replace("theta_rad = 0.05", f"theta_rad = {0.02 + 0.005 * k}"), encoding="utf-8"
        )
    done = rockcheck("compare", *names, "-e", "analytic", "-e", "pymunk", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    over_all = json.loads(done.stdout)["over_all_scenes"]
    assert list(over_all) == ["pymunk"]
    assert over_all["pymunk"]["cases"] == 9
    assert over_all["pymunk"]["peaks"]["size_a"] == 9
    few = rockcheck("compare", *names[:2], "-e", "analytic", "-e", "pymunk", "--json", cwd=tmp_path)
    told = json.loads(few.stdout)["over_all_scenes"]["pymunk"]
    assert (told["reference"], told["same"], told["cases"], told["peaks"]) == ("analytic", 2, 2, None)


def test_a_single_instant_is_no_agreement(tmp_path: Path) -> None:
    (tmp_path / "one.csv").write_text("t_s,theta_rad\n0,0\n")
    (tmp_path / "two.csv").write_text("t_s,theta_rad\n0,0\n1,0.1\n")
    done = rockcheck("compare", "one.csv", "two.csv", cwd=tmp_path)
    assert (done.returncode, "one common instant" in done.stderr) == (2, True), done.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "{}.toml"],
        ["run", "block.toml", "--out", "{}"],
        ["study", "{}.toml"],
        ["validate", "{}.csv"],
        ["compare", "{}.csv", "b.csv"],
        ["report", "{}"],
        ["gif", "{}"],
        ["figures", "{}"],
        ["mesh", "inspect", "{}.obj"],
        ["motion", "inspect", "{}.V2"],
    ],
)
def test_a_name_too_long_is_a_mistake(scene: Path, tmp_path: Path, arguments: list[str]) -> None:
    done = rockcheck(*(part.format("a" * 300) for part in arguments), cwd=tmp_path)
    assert (done.returncode, "too long" in done.stderr) == (2, True), done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["block.toml"]


@pytest.mark.parametrize("command", ["run", "study", "motion inspect", "mesh inspect", "report", "compare"])
@pytest.mark.parametrize("name", [".", "..", "/"])
def test_a_folder_is_no_file(tmp_path: Path, command: str, name: str) -> None:
    assert rockcheck(*command.split(), name, cwd=tmp_path).returncode == 2
    assert not list(tmp_path.iterdir())


def test_a_name_that_is_no_text_is_carried_through(scene: Path, tmp_path: Path) -> None:
    name = os.fsdecode(b"bl\xffock")
    scene.rename(tmp_path / f"{name}.toml")
    done = subprocess.run(
        [*IN_A_PROCESS, "run", f"{name}.toml", "-e", "analytic"],
        cwd=tmp_path, capture_output=True, check=False, env=os.environ | {"PYTHONIOENCODING": "utf-8:strict"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "out" / name / "result.json").read_text())
    assert record["scene"]["file"] == f"{name}.toml"
    printed = rockcheck("run", f"{name}.toml", "-e", "analytic", "--json", cwd=tmp_path).stdout
    assert json.loads(printed.encode())["scene"]["file"] == f"{name}.toml"


def in_a_shell(words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run a line of bash in which `rockcheck` is the command."""
    line = words.replace("rockcheck", shlex.join(IN_A_PROCESS))
    return subprocess.run(["bash", "-c", line], cwd=cwd, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("rockcheck engines >/dev/full", "No space left"),
        ("ulimit -f 8; rockcheck run block.toml -e analytic", "File too large"),
    ],
)
def test_a_full_disk_is_told_without_a_traceback(scene: Path, tmp_path: Path, line: str, said: str) -> None:
    done = in_a_shell(line, tmp_path)
    assert done.returncode == 1
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [scene]


def test_where_there_is_no_room_for_its_page_a_result_stands_without_an_older_one(scene: Path, tmp_path: Path) -> None:
    line = ("run", "block.toml", "-e", "analytic", "--set", "initial.theta_rad=0.05")
    assert rockcheck(*line, cwd=tmp_path).returncode == 0
    second = in_a_shell(f"ulimit -f 200; rockcheck {shlex.join(line).replace('0.05', '0.06')}", tmp_path)
    assert second.returncode == 1, second.stderr
    folder = tmp_path / "out" / "block"
    assert {path.name for path in folder.iterdir()} - {"conservator.html"} == {"result.json", "history_analytic.csv"}
    assert json.loads((folder / "result.json").read_text())["scene"]["initial"]["theta_rad"] == 0.06
    assert "report.html" in second.stderr
    assert "`rockcheck report out/block`" in second.stderr
    assert "fault" not in second.stderr


def test_a_result_whose_pages_were_interrupted_is_said_to_stand(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ended(*given: Any) -> Path:
        raise KeyboardInterrupt

    monkeypatch.setattr("reports.pages.page.write_report", ended)
    done = rockcheck("run", "block.toml", "-q", "-e", "analytic", cwd=tmp_path)
    assert done.returncode == INTERRUPTED
    assert "`rockcheck report out/block`" in done.stderr
    assert (tmp_path / "out" / "block" / "result.json").exists()


def test_what_an_ended_run_had_finished_is_written(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = scene_run.simulate_with

    def ended(engine: Engine, *given: Any) -> Run:
        if engine.name == "pymunk":
            raise KeyboardInterrupt
        return whole(engine, *given)

    monkeypatch.setattr(scene_run, "simulate_with", ended)
    done = rockcheck("run", "block.toml", "-q", "-e", "analytic", "-e", "pymunk", cwd=tmp_path)
    assert done.returncode == INTERRUPTED
    assert "`rockcheck report out/block`" in done.stderr
    folder = tmp_path / "out" / "block"
    assert {path.name for path in folder.iterdir()} == {"result.json", "history_analytic.csv"}
    record = json.loads((folder / "result.json").read_text())
    outcomes = {name: run["outcome"] for name, run in record["runs"].items()}
    assert outcomes == {"analytic": "stands", "pymunk": "crashed"}
    assert record["runs"]["pymunk"]["message"] == scene_run.ENDED
    page = write_report(folder, "it").read_text()
    assert scene_run.ENDED not in page, "an Italian page had English in it"
    last = re.findall(r"<td[^>]*>([^<]*)</td>\s*</tr>", page[page.index('id="outcomes"') : page.index('id="notes"')])
    assert set(last[1:]) == {"–"}, "a run that never began had a largest rotation of nought"


def test_asked_to_end_a_command_is_interrupted(capsys: pytest.CaptureFixture[str]) -> None:
    before = signal.getsignal(signal.SIGTERM)
    assert guarded(lambda: signal.raise_signal(signal.SIGTERM)) == INTERRUPTED
    assert signal.getsignal(signal.SIGTERM) is before


def test_an_output_that_is_a_file_is_one_mistake(scene: Path, tmp_path: Path) -> None:
    for command in ("run block.toml", "assess block.toml", "motion inspect block.toml", "bench", "stress"):
        for out in ("block.toml", "block.toml/below"):
            done = rockcheck(*command.split(), "--out", out, cwd=tmp_path)
            assert (done.returncode, done.stderr.count("wanted")) == (2, 1), done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["block.toml"]


def test_asking_for_help_imports_no_simulator(tmp_path: Path) -> None:
    code = (
        "import sys\nfrom reports.cli import app\n"
        "try:\n    app(['run', '--help'])\nexcept SystemExit:\n    pass\n"
        "heavy = {'pybullet', 'pymunk', 'trimesh', 'matplotlib', 'vl_convert', 'scipy', 'numba'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize(("words", "known"), [("rockcheck st", "stress"), ("rockcheck run -e py", "pymunk")])
def test_a_shell_completes_commands_and_engines(words: str, known: str) -> None:
    asked = {"_ROCKCHECK_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))}
    command = Path(sys.executable).with_name("rockcheck")
    done = subprocess.run([command], env={**os.environ, **asked}, capture_output=True, text=True, check=False)
    assert known in done.stdout.split()
