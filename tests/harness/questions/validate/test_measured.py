"""Measured drops and impact ratios: read with every mistake told, scored by hand-computed values, what threw them found again."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness import InputError, load_scene, simulate
from harness.model import Contact, Scene
from harness.questions.validate import drops, measured_set
from harness.questions.validate.drops import (
    TURNS,
    Drop,
    Fit,
    crps,
    fit,
    forecast,
    log_scores,
    read_drops,
    scene_of,
    turns_by_drop,
)
from harness.questions.validate.measured_set import by_name, read_ratios, repeats_sd
from harness.questions.validate.scenes import parse_model
from harness.questions.validate.validation_run import kind_of, validate_measured
from harness.runs.runner import InlinePool
from reports.messages import ENGLISH, LANGUAGES, language
from reports.pages.page import write_report
from reports.terminal import COLUMNS as WIDTH
from reports.terminal import LINES, record_lines
from tests import budgets_spatial as budget

RESTITUTION, FRICTION = 0.4, 0.15


@pytest.fixture(scope="session")
def square(root: Path) -> Scene:
    return load_scene(root / "scenes" / "square_drop.toml")


def start(seed: int) -> np.ndarray:
    """x, z, θ and their rates, some 15 frames over the ground."""
    random = np.random.default_rng(seed)
    return np.array(
        [[0.0, random.uniform(-1.0, 1.0)], [0.2, -1.0], [random.uniform(-3.0, 3.0), random.uniform(-9.0, 9.0)]]
    )


def thrown(square: Scene, seed: int, friction: float = FRICTION) -> np.ndarray:
    """Frames (row, x, z, θ, and rates that nobody reads) of one drop as pymunk throws it."""
    drop = Drop("", np.zeros((3, 2)), np.zeros((3, 2, 2)), 9.81, 0.8, 0, 0)
    contact = Contact(friction, friction, friction, RESTITUTION)
    run = simulate(scene_of(square, drop, start(seed), contact), "spatial", accuracy_rad=1e-3)
    extra = run.history.extra
    theta = -np.unwrap(run.history.theta_rad)
    theta += start(seed)[2, 0] - theta[0]
    # The corner and the centroid are a fixed distance apart, whichever way the body has turned.
    x = extra["corner_right_x_m"] - 0.03 * (np.cos(theta) + np.sin(theta))
    z = extra["corner_right_z_m"] - 0.03 * (np.sin(theta) - np.cos(theta))
    return np.column_stack([np.arange(x.size), x, z, theta, np.zeros((x.size, 3))])


def written(folder: Path, frames: dict[str, np.ndarray]) -> Path:
    lines = [f"{name},{','.join(f'{value:.9g}' for value in row)}" for name, rows in frames.items() for row in rows]
    path = folder / "drops.csv"
    path.write_text("\n".join([",".join(drops.COLUMNS), *lines]) + "\n", encoding="utf-8")
    return path


def test_a_drop_is_read_by_its_flight_and_begins_just_before_it_lands(tmp_path: Path, square: Scene) -> None:
    frames = thrown(square, 0)
    frames[:, 2] += 0.0015
    on_ground, leaning = frames[-20:].copy(), frames[:60].copy()
    on_ground[:, 0] = np.arange(len(on_ground))
    leaning[-1, 3] = 0.7
    found, refused = read_drops(written(tmp_path, {"a": frames, "b": on_ground, "c": leaning}), square)
    assert refused == {"b": "no_flight", "c": "not_at_rest"}
    drop = found[0]
    assert drop.fall_m_s2 == pytest.approx(9.81, abs=budget.FALL_READ_M_S2)
    t_s = (len(frames) * drops.FRAME_S) - drop.end_s - drops.FRAME_S
    (x, u), (z, v), (theta, rate) = start(0)
    wanted = [[x + u * t_s, u], [z + v * t_s - 0.5 * 9.81 * t_s**2, v - 9.81 * t_s], [theta + rate * t_s, rate]]
    assert drop.start == pytest.approx(np.array(wanted), abs=budget.START_READ)
    assert drop.turn == round(frames[-1, 3] / (0.5 * math.pi))


def test_a_drop_straight_down_is_read_without_scatter_aside(tmp_path: Path, square: Scene) -> None:
    frames = thrown(square, 0)
    frames[:, 1] = 0.0
    (drop,), _ = read_drops(written(tmp_path, {"a": frames}), square)
    assert not drop.scatter[0].any()
    assert drop.scatter[1].any()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: text.replace("x_m", "y_m", 1), "header: wanted drop, row, x_m"),
        (lambda text: text.replace("\na,1,", "\na,2,", 1), "drop a: row: wanted 0, 1, 2"),
        (lambda text: text.replace("\na,3,", "\na,x,", 1), "line 5: wanted "),
        (lambda text: text.replace("\na,3,", "\na,nan,", 1), "line 5: wanted "),
        (lambda text: text.replace("\na,3,", "\na,3,3,", 1), "line 5: .* 8 .* 9"),
        (lambda text: text + "b" + text.splitlines()[1][1:] + "\n" + text.splitlines()[1] + "\n", "drop a: "),
        (lambda text: text.splitlines()[0], "at least one line"),
    ],
)  # fmt: skip
def test_a_wrong_table_of_drops_says_where(tmp_path: Path, square: Scene, change, message: str) -> None:  # type: ignore[no-untyped-def]
    path = written(tmp_path, {"a": np.column_stack([np.arange(9.0), *np.zeros((6, 9))])})
    path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(InputError, match=message):
        read_drops(path, square)


def test_scores_are_those_computed_by_hand() -> None:
    p = np.zeros((1, TURNS.size))
    p[0, [24, 25]] = 0.25, 0.75
    assert log_scores(p, [1]) == pytest.approx([-math.log(0.75)])
    # F is 0.25 at 0 and 1 from 1 on: seen 1 leaves 0.25² at 0; seen 3 leaves 1 at 1 and at 2 too.
    assert crps(p, [1]) == pytest.approx([0.0625])
    assert crps(p, [3]) == pytest.approx([2.0625])


def test_draws_without_an_end_are_left_out_and_the_weights_find_what_threw() -> None:
    """Draws whose end is their restitution's: the fit weighs those that were seen, and leaves little to the background."""
    drawn = drops.coefficients(200, 0)
    ends: list[int | None] = np.round(10.0 * drawn[:, 0]).astype(int).tolist()
    behind = np.tile(drops.smoothed(np.arange(9)), (12, 1))
    answers = {str(k): ends for k in range(12)}
    best = fit(drawn, answers, behind, [4] * 12)
    assert best.means[0] == pytest.approx(0.4, abs=budget.WEIGHED_RESTITUTION)
    none = forecast(replace(best, background=0.0), drawn, {"a": [None] * 199 + [7]}, behind[:1])
    assert none[0, 24 + 7] == 1.0
    nothing = forecast(Fit((0.5, 0.2), (0.1, 0.1), 0.0), drawn, {"a": [None] * 200}, behind[:1])
    assert nothing[0] == pytest.approx(behind[0])


@pytest.mark.parametrize("name", ["spatial", "pymunk:plain"])
def test_a_draw_at_the_coefficients_that_threw_ends_as_it_did(
    tmp_path: Path, square: Scene, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of drops whose landing is read to a micrometre; one of six may be sent another way by that."""
    read, _ = read_drops(written(tmp_path, {str(seed): thrown(square, seed) for seed in range(6)}), square)
    monkeypatch.setattr(drops, "coefficients", lambda samples, seed: np.array([[RESTITUTION, FRICTION]]))
    ends = [drops.turns(square, parse_model(name), 1, 0, drop)[0] for drop in read]
    assert sum(end == drop.turn for end, drop in zip(ends, read, strict=True)) >= len(read) - 1
    assert len({drop.turn for drop in read}) > 2


def test_a_draw_that_fails_costs_itself_and_a_model_is_lost_with_all_alone() -> None:
    drop, told = Drop("a", np.zeros((3, 2)), np.zeros((3, 2, 2)), 9.81, 0.1, 0, 0), list[int]()
    answers = {"a": [1, None], "b": "no"}
    found = by_name(InlinePool(), lambda each: answers[each.name], [drop, replace(drop, name="b")], told.append)
    assert told == [1, 2]
    assert turns_by_drop(found, 2) == {"a": [1, None], "b": [None, None]}
    assert turns_by_drop({"a": "no", "b": "no"}, 2) == "no"


def test_a_set_of_drops_is_scored_and_told(tmp_path: Path, root: Path, square: Scene) -> None:
    table = written(tmp_path, {str(seed): thrown(square, seed) for seed in range(8)})
    body = root / "scenes" / "square_drop.toml"
    asked = {"models": ["spatial", "analytic"], "samples": 6, "jobs": 1, "quiet": True}
    record = validate_measured(table, tmp_path / "out", body=body, say=ENGLISH.say, **asked)  # type: ignore[arg-type]
    models, every = record.tables
    assert [row[0] for row in models.rows] == ["spatial", "all_drops", "first_face"]
    assert not any("_" in language(code).word(str(row[0])) for row in models.rows for code in LANGUAGES)
    assert len(every.rows) == 8 - round(8 / 3)
    scores = [row[every.columns.index("log_score")] for row in every.rows]
    assert np.mean(scores) == pytest.approx(models.rows[0][1])
    assert {each.code for each in record.findings} == {"drops_dragged", "model_not_run"}
    lines = record_lines(record)
    assert len(lines) <= LINES
    assert max(map(len, lines)) <= WIDTH
    assert json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))["answer"]["text"]
    assert "Every scored drop" in write_report(tmp_path / "out").read_text(encoding="utf-8")


def ratios(folder: Path, rows: list[str]) -> Path:
    path = folder / "ratios.csv"
    path.write_text("\n".join([",".join(measured_set.RATIO_COLUMNS), *rows]) + "\n", encoding="utf-8")
    return path


def test_ratios_are_held_against_the_model_and_an_imposed_one(tmp_path: Path) -> None:
    """A block of H/B 2 keeps 1 − 1.5/5 = 0.7, one of 3 keeps 0.85."""
    rows = ["1,1,0.1,0.2,0.1,1,0.68", "1,2,0.1,0.2,0.1,1,0.70", "2,1,0.1,0.3,0.1,1,0.85", "2,2,0.1,0.3,0.1,1,0.89"]
    table = ratios(tmp_path, rows)
    assert repeats_sd(read_ratios(table)) == pytest.approx(math.sqrt((2 * 0.01**2 + 2 * 0.02**2) / 2))
    record = validate_measured(table, tmp_path / "out", quiet=True, say=ENGLISH.say)
    laws, groups = record.tables
    (_, bias, rms, share, count, scatter), imposed = laws.rows
    assert (bias, rms) == (pytest.approx(-0.005), pytest.approx(math.sqrt((0.02**2 + 0.04**2) / 4)))
    assert (share, count) == (pytest.approx(rms / scatter), 4)
    # Each block by the other's mean: 0.87 − 0.69 either way.
    assert imposed[2] == pytest.approx(math.sqrt(0.18**2 + scatter**2 / 2))
    assert [row[6] for row in groups.rows] == [pytest.approx(0.01), pytest.approx(-0.02)]
    assert [row[4] for row in groups.rows] == [pytest.approx(0.01 * math.sqrt(2)), pytest.approx(0.02 * math.sqrt(2))]
    assert [row[7] for row in groups.rows] == [pytest.approx(scatter / math.sqrt(2))] * 2
    once = validate_measured(ratios(tmp_path, rows[:3]), tmp_path / "once", quiet=True).tables[1]
    assert [row[4] for row in once.rows] == [pytest.approx(0.01 * math.sqrt(2)), None], "one trial has no spread"
    page = write_report(tmp_path / "out").read_text(encoding="utf-8")
    assert "By block" in page
    assert "<td>4</td>" in page, "a count has no decimals"


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (["1,1,0.1,0.2,0.1,1,0.9", "1,2,0.1,0.3,0.1,1,0.9"], "group 1: "),
        (["1,1,0.1,0.2,0.1,1,-0.9", "1,2,0.1,0.2,0.1,1,0.9"], "wanted positive ratios"),
        (["1,1,0.1,0.2,0.1,1,0.9", "1,2,0.1,0.2,0.1,1,0.9"], "wanted two groups"),
        (["1,1,0.1,0.2,0.1,1,0.9", "2,2,0.1,0.2,0.1,1,0.9"], "a repeated trial"),
    ],
)  # fmt: skip
def test_wrong_ratios_say_where(tmp_path: Path, rows: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_ratios(ratios(tmp_path, rows))


def test_a_table_is_known_by_its_columns_and_takes_its_own_options(tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    body = tmp_path / "body.toml"
    for first, kind in (("toss", "tosses"), ("drop", "drops")):
        table.write_text(f"{first},a\n", encoding="utf-8")
        assert kind_of(table, body=body, engine=["spatial"], samples=0, resume=False, fit_share=None) == kind
        with pytest.raises(InputError, match=r"^--body: .* got nothing"):
            kind_of(table, body=None)
        with pytest.raises(InputError, match=f"^--resume: .* {kind}, got True"):
            kind_of(table, body=body, resume=True)
    table.write_text("group,trial\n", encoding="utf-8")
    assert kind_of(table, body=None) == "impact_ratios"
    with pytest.raises(InputError, match=r"^--engine: .*spatial"):
        kind_of(table, engine=["spatial"])
    table.write_text("# a comment\ntest;scene;observed\n", encoding="utf-8")
    assert kind_of(table, samples=5, fit_share="odd") == "tests"
    with pytest.raises(InputError, match=r"^--body: .* got .*body\.toml"):
        kind_of(table, body=body)


def test_a_body_beside_something_is_refused(tmp_path: Path, root: Path) -> None:
    table = written(tmp_path, {"a": np.zeros((9, 7))})
    with pytest.raises(InputError, match=": pedestal: "):
        validate_measured(table, tmp_path / "out", body=root / "scenes" / "paestum_block.toml")
    assert not (tmp_path / "out").exists()


def test_real_drops_and_ratios_read(data_dir: Path, square: Scene, tmp_path: Path) -> None:
    drops_table, table = (
        data_dir / "squares" / "square_drops.csv.gz",
        data_dir / "impacts" / "limestone_first_impacts.csv",
    )
    if not drops_table.is_file() or not table.is_file():
        pytest.skip(f"real data absent: {drops_table}")
    found, refused = read_drops(drops_table, square)
    assert (len(found), len(refused)) == (125, 0)
    assert np.median([drop.fall_m_s2 for drop in found]) == pytest.approx(9.0, abs=budget.PLATES_FALL_M_S2)
    record = validate_measured(table, tmp_path / "out", quiet=True)
    assert record.tables[0].rows[0][1:3] == pytest.approx([0.0134, 0.0427], abs=budget.LIMESTONE)


@pytest.mark.parametrize(("gains", "told", "code"), [
    ((0.4, 0.6), "more", "drops_told"), ((0.1, 0.6), "chance", "drops_not_told"), ((-0.43, 0.1), "less", "drops_not_told"),
])  # fmt: skip
def test_a_model_that_a_rule_without_one_beats_is_not_called_the_likeliest(
    gains: tuple[float, float], told: str, code: str
) -> None:
    row = {"model": "spatial", "log_score": 2.46, "gain_all_drops": gains[1], "gain_first_face": gains[0]}
    whole = dict.fromkeys(drops.SCORES, 0.146) | row
    found = drops._answer([[whole[name] for name in drops.SCORES]], 8, 12)
    assert found.code == code
    assert (found.findings[0].values["told"], found.findings[0].values["gain"]) == (told, abs(gains[0]))
