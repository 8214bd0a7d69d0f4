"""A whole validation: runs, resumes, fits, scores, and compares a measured history."""

import json
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from harness import InputError, simulate
from harness.comparison.statistics import FELL
from harness.model import read_each
from harness.questions.validate import validation_run as run
from harness.questions.validate.scenes import intensity_of, parse_model, read_table, scene_of
from harness.records.validation import Fitted, FittedInput
from harness.runs.runner import InlinePool
from reports.cli import app
from reports.messages import ENGLISH
from reports.pages.page import write_report
from reports.terminal import LINES
from tests.harness.questions.validate.experiments import (
    read_rows,
    seen,
    validate,
    variant,
    write_experiments,
    write_table,
)

AMPLITUDES = (2.0, 3.0, 4.0, 5.0, 7.0, 8.0, 9.0, 10.0)
TRUE_AZIMUTH_DEG = 90.0


class Interrupted(InlinePool):
    """A pool that is interrupted after three batches."""

    def run(self, work: Callable[[Any], Any], tasks: Iterable[Any], done: Callable[[Any, Any], None]) -> None:
        super().run(work, islice(tasks, 3), done)
        raise KeyboardInterrupt


@pytest.fixture(autouse=True)
def inline(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "LocalPool", lambda jobs: InlinePool())


def measured(folder: Path) -> Path:
    """A table whose observations are the model's own at the second of three azimuths, two thirds of them a share to fit on."""
    path = write_experiments(folder, AMPLITUDES, azimuth_deg="0;90;180")
    rows = read_rows(path)
    for number, (row, trial) in enumerate(zip(rows, read_table(path), strict=True)):
        true = seen(trial, azimuth_deg=TRUE_AZIMUTH_DEG)
        row["observed"] = FELL if true.overturned else true.value
        row["share"] = "rest" if number % 3 == 2 else "fit"
    return write_table(path, rows)


def test_the_unknown_azimuth_is_found_and_the_rest_predicted(tmp_path: Path) -> None:
    path = measured(tmp_path)
    found = validate(path, tmp_path / "out", models=["analytic"], samples=2, quiet=True)
    model = found["models"]["analytic"]
    stands = [row["observed"] == "stands" for row in found["rows"]]
    assert 0 < sum(stands) < len(stands)
    assert model["fitted"]["tests"] == 6
    (azimuth,) = model["fitted"]["inputs"]
    assert (azimuth["body"], azimuth["input"], azimuth["at_end"]) == ("stone.ply", "azimuth_deg", False)
    assert azimuth["value"] in {0.0, 90.0, 180.0}
    assert 1 / 3 < azimuth["weight"] < 1.0
    assert model["tests"] == 2
    assert model["failed"] == 0
    # Six tests of the share at three azimuths in eight draws, and in two draws of four widths (of which some are the same); then
    # eight tests as fitted, and the two of the other share in two draws.
    assert 6 * 3 * 8 + 6 * 3 * 2 <= model["fitted"]["runs"] <= 6 * 3 * 8 + 6 * 4 * 2
    assert found["runs"]["computed"] == found["runs"]["wanted"] == model["fitted"]["runs"] + 8 + 2 * 2
    assert found["fit_share"] == {"name": "fit", "tests": 6}
    said = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    assert said == found | {"seal": said["seal"]}


def test_what_was_fitted_on_one_share_is_scored_by_the_falls_of_the_other(tmp_path: Path) -> None:
    path = write_experiments(tmp_path, AMPLITUDES, azimuth_deg="0;90;180")
    rows = read_rows(path)
    for number, (row, trial) in enumerate(zip(rows, read_table(path), strict=True)):
        true = seen(trial, azimuth_deg=180.0)
        row["observed"] = FELL if true.overturned else true.value
        row["share"] = "fit" if number % 2 else "rest"
    rest = rows[::2]
    assert [row["observed"] for row in rest] == ["stands", "stands", FELL, FELL]
    # Two wrong observations in the share that is scored: one fall that the model has and one that it has not.
    rest[0]["observed"], rest[2]["observed"] = FELL, "stands"
    found = validate(write_table(path, rows), tmp_path / "out", models=["analytic"], quiet=True)
    model = found["models"]["analytic"]
    assert [each["value"] for each in model["fitted"]["inputs"]] == [180.0]
    scores = model["outcomes"]
    assert (scores["cases"], scores["undecided"], scores["within_uncertainty"]) == (4, 0, 0)
    # Of two predicted falls one was seen, of two seen falls one was predicted.
    assert {name: scores[name]["value"] for name in ("accuracy", "precision", "recall", "f1", "matthews")} == {
        "accuracy": 0.5,
        "precision": 0.5,
        "recall": 0.5,
        "f1": 0.5,
        "matthews": 0.0,
    }


def test_a_wrong_observation_costs_exactly_itself(tmp_path: Path) -> None:
    path = write_experiments(tmp_path, AMPLITUDES)
    before = validate(path, tmp_path / "out", models=["analytic"], quiet=True)
    falls = {row["test"]: row["predicted"]["analytic"] for row in before["rows"]}
    rows = read_rows(path)
    for row in rows:
        row["observed"] = falls[row["test"]]
    right = validate(write_table(path, rows), tmp_path / "out", models=["analytic"], resume=True, quiet=True)
    rows[0]["observed"] = FELL
    wrong = validate(write_table(path, rows), tmp_path / "out", models=["analytic"], resume=True, quiet=True)
    assert right["runs"]["computed"] == wrong["runs"]["computed"] == 0
    accuracies = [each["models"]["analytic"]["outcomes"]["accuracy"]["value"] for each in (right, wrong)]
    sure = right["models"]["analytic"]["outcomes"]
    counted = sure["cases"] - sure["within_uncertainty"] - sure["undecided"]
    assert accuracies == [1.0, pytest.approx(1.0 - 1.0 / counted)]


def test_an_interrupted_call_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_experiments(tmp_path, AMPLITUDES)
    monkeypatch.setattr(run, "BATCH", {"analytic": 1})
    monkeypatch.setattr(run, "LocalPool", lambda jobs: Interrupted())
    with pytest.raises(KeyboardInterrupt):
        validate(path, tmp_path / "out", models=["analytic"], quiet=True)
    monkeypatch.setattr(run, "LocalPool", lambda jobs: InlinePool())
    found = validate(path, tmp_path / "out", models=["analytic"], resume=True, quiet=True)
    assert found["runs"] == {"wanted": len(AMPLITUDES), "computed": len(AMPLITUDES) - 3}


def test_settings_are_scored_apart(tmp_path: Path) -> None:
    path = write_experiments(tmp_path, AMPLITUDES[:2])
    found = validate(path, tmp_path / "out", models=["analytic", "analytic@accuracy=1e-5"], quiet=True)
    assert {name: model["accuracy_rad"] for name, model in found["models"].items()} == {
        "analytic": 1e-3,
        "analytic@accuracy=1e-5": 1e-5,
    }
    assert found["runs"]["computed"] == 4


def test_an_engine_is_asked_near_the_boundary_of_another_model_alone(tmp_path: Path) -> None:
    """Of bursts that leave it standing, that may throw it, and that do, the exact body is asked in the middle alone."""
    path = write_experiments(tmp_path, (1.0, 5.0, 5.25, 10.0))
    names = ["analytic", "spatial@near=analytic"]
    found = validate(path, tmp_path / "out", models=names, samples=6, quiet=True)
    model = found["models"]["spatial@near=analytic"]
    assert (model["near"], model["asked"]) == ("analytic", 2)
    assert [pair["cases"] for pair in found["pairs"]] == [2], "what is taken from the other agrees with it"
    p = [[row["probability"][name] for name in names] for row in found["rows"]]
    assert all(p[k][0] == p[k][1] for k in (0, 3))
    # Four tests as they are and in six draws by the model, two again by the exact body.
    assert found["runs"]["computed"] == 6 * 7
    assert {each["code"] for each in found["findings"]} >= {"asked_near"}


def test_progress_tells_the_whole_plan_before_anything_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[tuple[int, int]] = []

    @contextmanager
    def heard(title: str, quiet: bool) -> Iterator[Callable[[int, int], None]]:
        yield lambda done, of: told.append((done, of))

    monkeypatch.setattr(run, "progress", heard)
    monkeypatch.setattr(run, "read_each", lambda *asked: told.append((-1, -1)) or read_each(*asked))
    found = validate(measured(tmp_path), tmp_path / "out", models=["analytic"], samples=2, quiet=True)
    first, read, *others = told
    assert (first[0], read) == (0, (-1, -1))
    wanted = found["runs"]["wanted"]
    # Some draws of a width are those of a setting: known before they are asked again.
    assert wanted <= first[1] <= 1.1 * wanted
    assert others[-1] == (wanted, wanted)


def test_models_stand_beside_each_other_with_the_four_verdicts(tmp_path: Path) -> None:
    path = write_experiments(tmp_path, (4.0, 5.0, 7.0))
    names = ["analytic", "analytic@accuracy=1e-5", "pymunk@dt=0.002"]
    pairs = validate(path, tmp_path / "out", models=names, quiet=True)["pairs"]
    assert [(pair["a"], pair["b"]) for pair in pairs] == [
        (names[1], names[0]),
        (names[2], names[0]),
        (names[2], names[1]),
    ]
    assert [pair["cases"] for pair in pairs] == [3, 3, 3]
    assert pairs[0]["verdicts"]["agree within numerical error"] == 1.0
    assert pairs[0]["unstated"] == []
    # A bare step states no error: a difference may be that.
    assert pairs[1]["unstated"] == [names[2]]
    assert sum(pairs[1]["verdicts"].values()) == pytest.approx(1.0)
    assert pairs[1]["verdicts"]["differ: model"] == 0.0
    assert pairs[1]["verdicts"]["differ: numerical error not bounded"] > 0.0
    page = write_report(tmp_path / "out").read_text(encoding="utf-8")
    assert "pymunk@dt=0.002 and analytic</dt>" in page
    assert ENGLISH("text.unstated", names="pymunk@dt=0.002") in page


def test_a_swapped_label_is_named_on_terminal_and_page(tmp_path: Path) -> None:
    """Observed as the model has it, but for the strongest test, which is said to have stood."""
    path = write_experiments(tmp_path, AMPLITUDES)
    rows = read_rows(path)
    for row, trial in zip(rows, read_table(path), strict=True):
        row["observed"] = str(int(seen(trial).overturned))
    assert rows[-1]["observed"] == "1"
    rows[-1]["observed"] = "0"
    write_table(path, rows)
    answer = CliRunner().invoke(
        app, ["validate", str(path), "-e", "analytic", "--samples", "4", "-j", "1", "--out", str(tmp_path / "out")]
    )
    assert answer.exit_code == 0, answer.output
    record = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    assert record["unexplained"] == [rows[-1]["test"]]
    (told,) = (each for each in record["findings"] if each["code"] == "tests_unexplained")
    assert told["values"] == {"tests": [rows[-1]["test"]]}
    assert told["text"][:40] in answer.output
    lines = answer.stdout.splitlines()
    assert len(lines) <= LINES
    assert [line.split("  ")[1].strip() for line in lines if line.startswith("  ")][:3] == [
        "model",
        "analytic",
        "PGV threshold",
    ]
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert told["text"] in page
    assert ENGLISH("chart.validation_reliability").split(",")[0] in page
    assert "right, by P ≥ ½" in page


def test_a_label_that_another_value_of_the_list_explains_is_none_to_doubt(tmp_path: Path) -> None:
    """Worn by a sixth of its base the stone falls in what it stands whole; nothing was fitted, so draws take both."""
    path = write_experiments(tmp_path, [4.0, 4.25, 6.0], inset_m="0;0.02", observed="stands")
    trials = read_table(path)
    ends = [[seen(trial, inset_m=worn) for worn in (0.0, 0.02)] for trial in trials]
    differ = [k for k, (whole, worn) in enumerate(ends) if worn.overturned and not whole.overturned]
    assert differ
    rows = read_rows(path)
    for row, (whole, _) in zip(rows, ends, strict=True):
        row["observed"] = str(int(whole.overturned))
    rows[differ[0]]["observed"] = "1"
    found = validate(write_table(path, rows), tmp_path / "out", models=["analytic"], samples=8, quiet=True)
    assert found["unexplained"] == []
    assert found["unfitted"] == ["inset_m"]


def test_a_motion_of_any_named_columns_is_read(tmp_path: Path) -> None:
    """The same burst under headers that no reader knows: the same key figures, whatever else stands beside it."""
    path = write_experiments(tmp_path, [3.0, 3.0])
    times, table = np.loadtxt(tmp_path / "burst1.csv", delimiter=",", skiprows=1, unpack=True)
    lines = (";".join(f"{value:.9g}" for value in row) for row in zip(times, table, 7.0 * times, strict=True))
    text = "# lab 2\n\nMesszeit;Tisch;Seilzug mm\ns;m/s2;mm\n" + "\n".join(lines)
    (tmp_path / "burst1.csv").write_text(text.replace(".", ","))
    rows = read_rows(path)
    rows[1] |= {"time_column": "Messzeit", "column": "Tisch"}
    first, second = read_table(write_table(path, rows))
    assert intensity_of(second) == intensity_of(first)
    rows[1]["column"] = "Tish"
    wrong = read_table(write_table(path, rows))[1]
    with pytest.raises(InputError, match=r": column: .*Messzeit, Tisch, Seilzug mm, got 'Tish'"):
        intensity_of(wrong)
    (tmp_path / "burst1.csv").write_text("Messzeit;Tish;Notiz\n0;0;quiet\n")
    with pytest.raises(InputError, match=r": line 2: .* got 0, 0, quiet"):
        intensity_of(replace(wrong, name="words"))
    (tmp_path / "burst1.csv").write_text("0 0\n1 1\n")
    with pytest.raises(InputError, match=r": column: .* 1, 2, got nothing"):
        intensity_of(replace(wrong, time_column="1", column=None, name="unnamed"))


def test_a_measured_history_is_a_history_like_any_other(tmp_path: Path) -> None:
    path = write_experiments(tmp_path, [4.5], history="measured.csv")
    (tmp_path / "measured.csv").write_text("t_s,theta_rad\n0,0\n1,0\n")
    (trial,) = read_table(path)
    true = simulate(scene_of(trial, variant(trial)), "analytic")
    louder = replace(true.history, theta_rad=1.1 * true.history.theta_rad)
    louder.write_csv(tmp_path / "measured.csv")
    rows = [row | {"history_uncertainty_rad": 0.001} for row in read_rows(path)]
    found = validate(write_table(path, rows), tmp_path / "out", models=["analytic"], samples=6, quiet=True)
    scores = found["models"]["analytic"]["histories"][0]["scores"]
    error = scores["comparison_error"]
    assert error["u_data_rad"] == 0.001
    assert error["u_input_rad"] > 0.0
    assert error["error_rad"] == pytest.approx(-0.1 * abs(true.peak_theta_rad), rel=1e-2)
    assert scores["b"] == "measured t0"
    assert scores["evidence"]["uncertainty_a_rad"] == true.numerical_uncertainty_rad
    assert scores["horizon_s"] == true.reliable_until_s
    assert scores["peak_ratio"] == pytest.approx(1.0 / 1.1, rel=1e-3)  # the scaled rates were left as they were


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"models": ["analytik"]}, "did you mean analytic"),
        ({"models": ["pymunk@steps=3"]}, "ENGINE@accuracy=RAD"),
        ({"models": ["pymunk@dt=fast"]}, "ENGINE@dt=S"),
        ({"models": ["pymunk@dt=5"]}, "a step between"),
        ({"samples": -1}, "from 0 to"),
        ({"models": ["spatial@near=analytic"], "samples": 2}, "a model that is named before"),
        ({"models": ["analytic", "spatial@near=analytic"]}, "draws, which tell what is near"),
        ({"resume": True}, "begun"),
    ],
)
def test_a_wrong_option_is_told_before_anything_is_written(tmp_path: Path, options: dict[str, Any], says: str) -> None:
    path = write_experiments(tmp_path, [2.0])
    with pytest.raises(InputError, match=says):
        validate(path, tmp_path / "out", **{"models": ["analytic"], "quiet": True} | options)
    assert not (tmp_path / "out").exists()


def test_every_unreadable_file_is_told_at_once(tmp_path: Path) -> None:
    path = write_experiments(tmp_path, [2.0, 3.0])
    (tmp_path / "burst0.csv").write_text("time_s,table\n0,0\n")
    (tmp_path / "burst1.csv").write_text("time_s,other\n0,0\n0.01,1\n0.02,0\n")
    with pytest.raises(InputError) as caught:
        validate(path, tmp_path / "out", models=["analytic"], quiet=True)
    assert "burst0.csv" in str(caught.value)
    assert "burst1.csv" in str(caught.value)


def test_a_model_is_an_engine_with_a_setting() -> None:
    assert parse_model("pymunk@dt=5e-4").dt_s == 5e-4
    assert parse_model("pymunk@dt=5e-4").accuracy_rad is None
    assert parse_model("analytic@accuracy=1e-6").accuracy_rad == 1e-6


def test_what_is_fitted_at_the_end_of_its_list_is_told_by_input() -> None:
    rows = [
        FittedInput(body, "", name, 0.0, 0.5, at_end)
        for body, name, at_end in [
            ("b.ply", "scale", True), ("a.ply", "inset_m", True), ("b.ply", "inset_m", True), ("c.ply", "inset_m", False),
        ]
    ]  # fmt: skip
    item = SimpleNamespace(
        outcomes=SimpleNamespace(within_uncertainty=0, undecided=0),
        fitted=Fitted(3, 0.5, 1.0, False, 0.25, rows),
        near="",
        failed=0,
        probability=SimpleNamespace(reliability=[]),
    )
    (found,) = run._of_model(item)  # type: ignore[arg-type]
    assert found.code == "fitted_at_end"
    assert found.values == {"inputs": ["inset_m (a.ply, b.ply)", "scale (b.ply)"]}
