"""The bench: errors that see a wrong run, sentences that follow from the rows, failures kept as rows."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness import engines
from harness.bench import other_integrators as others
from harness.bench import precision, scaling, sentences, skips
from harness.bench import skip_savings as alone
from harness.bench.standard_scenes import COLUMN, Standard, resolved, scene_of, standard_set
from harness.bench.timing import children_cpu_s, cost, costs, largest_child_mb
from harness.engines.base import EngineFailure
from harness.model.history import History
from harness.model.options import SKIPS, RunOptions

FREE = Standard("short", {"duration_s": 0.4, "statue": COLUMN, "initial": {"theta_rad": 0.05}}, "analytic")


def row(engine: str, scene: str, label: str, error_rad: float, cpu_s: float, **more: Any) -> dict[str, Any]:
    """An invented row."""
    plain = {"engine": engine, "scene": scene, "label": label, "error_rad": error_rad, "cpu_s": cpu_s, "block": True}
    return plain | {"group": "ladder", "failed": None, "real_time_factor": 1.0 / cpu_s} | more


ROWS = [
    row("pymunk", "easy", "coarse", 1e-4, 0.001),
    row("pymunk", "easy", "fine", 1e-5, 0.1),
    row("pymunk", "hard", "coarse", 1e-1, 0.001),
    row("pymunk", "hard", "fine", 1e-4, 0.1),
    row("pymunk", "easy", "to 1e-3", 1e-4, 0.002, group="accuracy"),
    row("pymunk", "hard", "to 1e-3", 1e-4, 0.2, group="accuracy"),
]


def test_the_choice_is_compared_with_the_fixed_rung_that_meets_every_scene() -> None:
    found = sentences.choice(ROWS, 1e-3)[0]
    assert found["fixed_s"] == pytest.approx(0.2)
    assert found["share"] == pytest.approx(0.202 / 0.2)
    assert found["worst_times"] == pytest.approx(2.0)
    assert found["met"] == 2


def test_a_rung_is_known_by_its_place_in_the_ladder() -> None:
    other = [item | {"label": f"{item['label']}, {item['scene']}"} for item in ROWS if item["group"] == "ladder"]
    asked = [item for item in ROWS if item["group"] != "ladder"]
    assert sentences.choice([*other, *asked], 1e-3) == sentences.choice(ROWS, 1e-3)


def test_no_fixed_rung_is_said() -> None:
    worse = [item | {"error_rad": 1.0} if item["scene"] == "hard" else item for item in ROWS]
    found = sentences.choice(worse, 1e-3)[0]
    assert found["fixed_s"] is None
    assert found["worst_scene"] == "easy"
    assert found["met"] == 1


def test_the_slowest_scene_of_the_fastest_rung_that_meets_the_target() -> None:
    assert sentences.fastest(ROWS, 1e-3) == {"pymunk": (pytest.approx(10.0), "hard")}
    assert sentences.fastest(ROWS, 1e-6)["pymunk"][0] == 0.0


def test_sentences_follow_the_rows() -> None:
    record = {
        "rows": ROWS, "target_rad": 1e-3, "choice": sentences.choice(ROWS, 1e-3),
        "coverage": {"pymunk": {"inside": 19, "total": 20}},
        "skips": [{"skip": "all together", "engine": "pymunk", "scenes": 6, "gain": 1.5, "same": True, "changed": []}],
    }  # fmt: skip
    told = " ".join(sentences.sentences(record))
    assert "short of the 250 wanted" in told
    assert "19 of 20 seeded scenes (at least 95%)" in told
    assert "1.5 times faster (short of 2 wanted); no outcome changed" in told
    faster = {**record, "skips": [record["skips"][0] | {"gain": 3.0, "same": False, "changed": ["a: b"]}]}
    assert "3 times faster (at least 2 wanted); a: b" in " ".join(sentences.sentences(faster))


def test_an_error_is_seen() -> None:
    engine = engines.load("analytic")
    run = engine.simulate(FREE.scene(), engine.refinement_levels(FREE.scene())[-1], RunOptions())
    h = run.history
    assert h is not None
    assert precision.error(run, run) == 0.0
    shifted = History(h.t_s, h.theta_rad + 1e-5, h.theta_rate_rad_s, h.slip_m, h.slip_rate_m_s)
    assert precision.error(replace(run, history=shifted), run) == pytest.approx(1e-5)
    assert precision.error(replace(run, history=None), run) == np.inf


def test_rows_of_an_engine_its_defaults_and_a_peer() -> None:
    rows = list(precision.rows_of(FREE, FREE.scene(), ["pymunk", "pybullet"], quick=True))
    groups = {(item["engine"], item["group"]) for item in rows}
    assert {("pymunk", "ladder"), ("pymunk", "accuracy"), ("pybullet", "default"), ("pybullet", "peer")} <= groups
    errors = {(item["engine"], item["label"]): item["error_rad"] for item in rows}
    best = min(error for (name, _), error in errors.items() if name == "pybullet")
    peer = next(error for (_, label), error in errors.items() if label.startswith("virtual_shake_robot"))
    assert peer > 3.0 * best, "compliant contact was measured to cost half a peak"
    assert all(item["cpu_s"] > 0.0 and item["real_time_factor"] > 0.0 for item in rows)


def test_a_failing_rung_stays_as_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    from harness.engines.pymunk import Munk2D

    def refuses(*args: object) -> None:
        raise EngineFailure("no such scene for me")

    monkeypatch.setattr(Munk2D, "simulate", refuses)
    monkeypatch.setattr(precision, "_rivals", lambda *args: iter(()))
    rows = list(precision.rows_of(FREE, FREE.scene(), ["pymunk"], quick=True))
    assert rows
    assert {item["failed"] for item in rows} == {"no such scene for me"}


def test_scenes_without_their_files_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROCKCHECK_DATA", "/nowhere")
    found, absent = resolved(standard_set())
    assert {item.name for item, _ in found} | set(absent) == {item.name for item in standard_set()}
    assert len(absent) == 3
    (row,) = skips.compute("analytic: block, elcentro1940")
    assert "elcentro1940" in row["failed"]
    assert skips.together([row])[0]["failed"] == row["failed"]
    assert "elcentro1940" in alone.compute("no_history: analytic")[0]["failed"]
    assert precision.of(True, next(iter(absent)))[0]["absent"] == absent[next(iter(absent))]


def test_cost_is_the_least_of_several() -> None:
    calls: list[int] = []
    spent = cost(lambda: calls.append(sum(range(20_000))), repeats=4)
    assert len(calls) == spent.repeats == 4
    assert 0.0 < spent.cpu_s <= spent.wall_s * 1.5


@pytest.mark.parametrize("name", ["analytic", "pymunk"])
def test_skips_change_no_outcome_on_a_real_record(data_dir: object, name: str) -> None:
    engine = engines.load(name)
    outcomes = set()
    for scene in skips.outcome_scenes(skips.STUDY, (1.1, 6.0)):
        on, off = skips.simulate(engine, scene, skips.ALL), skips.simulate(engine, scene, skips.NONE)
        assert on.outcome is off.outcome, scene.title
        assert on.history is None
        outcomes.add(on.outcome.value)
    assert len(outcomes) > 1, "amplitudes on both sides of overturning are wanted"


def test_a_scene_of_the_set_is_a_scene_file() -> None:
    for item in standard_set():
        assert item.content["duration_s"] > 0.0
    assert scene_of("x", FREE.content).statue.mass_kg == COLUMN["mass_kg"]


def test_every_skip_of_every_engine_is_measured_alone() -> None:
    declared = {(skip, name) for name in engines.REGISTRY for skip in engines.load(name).capabilities.skips}
    assert {(skip, name) for skip, named in alone.CASES.items() for name in named} == declared
    measured = {task.partition(": ")[0] for task in alone.tasks(False)}
    assert measured == set(SKIPS), "what no engine declares is measured too"


def test_skips_that_gain_nothing_or_move_a_rotation_are_told() -> None:
    plain = {"engine": "pymunk", "same": True, "changed": [], "apart_rad": 1e-4, "own_rad": 1e-3, "gain": 2.0}
    rows = [
        plain | {"skip": "quiet_end"}, plain | {"skip": "no_history", "gain": 1.01},
        plain | {"skip": "mirror", "apart_rad": 2e-3}, plain | {"skip": "cached", "same": False, "changed": ["computed again"]},
        {"skip": "planar", "engine": "*", "failed": "no record"}, {"skip": "all together", "engine": "pymunk"},
    ]  # fmt: skip
    told = alone.sentences(rows)
    assert told == [
        "Alone 3 of 4 skips gain a twentieth or more of the time where they were measured; not no_history (pymunk, 1).",
        "cached (pymunk): computed again.",
        "mirror (pymunk) parts rotations by 2.0e-03 rad, finer settings without it by 1.0e-03 rad.",
    ]
    assert alone.sentences([]) == []


def test_the_own_error_of_a_run_is_what_its_finer_settings_change() -> None:
    engine, scene = engines.load("pymunk"), FREE.scene()
    run = skips.simulate(engine, scene, skips.NONE, alone.RESOLVED_RAD)
    (probe,) = engine.verification_settings(scene, skips.level(engine, scene, alone.RESOLVED_RAD))
    finer = engine.simulate(scene, probe, skips.NONE)
    assert alone.own_error_rad(engine, scene, skips.NONE, run) == alone.difference(run, finer) > 0.0


def test_how_time_grows_is_told_from_the_largest_two() -> None:
    def point(quantity: str, value: float, wall_s: float) -> dict[str, Any]:
        return {"engine": "pymunk", "quantity": quantity, "value": value, "wall_s": wall_s, "memory_mb": 1.0}

    rows = [point("duration_s", 2.0, 0.9), point("duration_s", 8.0, 1.0), point("duration_s", 32.0, 4.0)]
    rows += [point("workers", 1.0, 3.0), point("workers", 2.0, 2.0), point("runs", 100.0, 1.0)]
    assert scaling.sentences(rows) == [
        "Scaling: pymunk's time grows with the power 1.00 of duration; 2 workers are 1.5 times as fast as 1."
    ]
    assert scaling.sentences([]) == []


def test_the_memory_of_workers_is_counted() -> None:
    code = "import sys; sys.stdout.write(str(len(bytearray(300_000_000))))"
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
    assert largest_child_mb() > 250.0
    assert children_cpu_s() > 0.0


def test_other_solvers_are_compared_at_equal_error() -> None:
    case = {"case": "block"}
    solvers = [
        case | {"solver": "analytic", "error_rad": 1e-10, "seconds": 0.001},
        case | {"solver": "analytic", "error_rad": 1e-4, "seconds": 0.0001},
        case | {"solver": "scipy DOP853", "error_rad": 1e-7, "seconds": 0.2},
        case | {"solver": "heyoka", "failed": "not installed"},
        {"case": "two blocks", "solver": "analytic", "error_rad": 1e-10, "seconds": 0.001},
    ]
    rates = {"two_block": {"runs_per_core_s": 9000.0}, "map": {"size": 200, "threads": 2, "wall_s": 4.0}}
    ratios = {"no_pedestal_ratio": 0.5, "pedestal_ratio": 1.2}
    start = {"import_ratio": 1.2, "first_call_ratio": 2.5}
    found = {"solvers": solvers, "throughput": rates, "startup": start, "overhead": ratios}
    told = others.sentences(found)
    assert "block: at 1e-06 rad analytic is 200 times as fast as scipy DOP853 (at least 100 wanted)" in told[0]
    assert told[1] == (
        "block: no setting of scipy DOP853 reached 1e-09 rad; at its smallest error, 1e-07, analytic is 200 times as fast as "
        "scipy DOP853."
    )
    assert "not installed" in told[2]
    assert "9e+03 a second and core (short of the 10000 wanted)" in told[3]
    assert "takes 4 s on 2 cores (at most 5 wanted)" in told[4]
    assert "Importing analytic takes 1.20 times" in told[5]
    assert "2.50 times that of a trivial cached kernel (above 2 wanted)" in told[6]
    assert "0.50 times a bare loop (at most" in told[7]
    assert "1.20 times a bare loop (above" in told[8]


@pytest.mark.parametrize(
    ("theirs_rad", "told"),
    [
        (1e-7, "; at its smallest error, 0.0001, analytic is 0.2 times as fast as scipy DOP853."),
        (1e-3, "; its smallest error is 0.0001."),
    ],
)
def test_an_error_that_is_not_reached_is_told_with_the_smallest_one(theirs_rad: float, told: str) -> None:
    ours = {"case": "block", "solver": "analytic", "error_rad": 1e-4, "seconds": 1.0}
    theirs = {"case": "block", "solver": "scipy DOP853", "error_rad": theirs_rad, "seconds": 0.2}
    found = others.sentences({"solvers": [ours, theirs], "throughput": {}, "startup": {}, "overhead": {}})
    assert found[0] == f"block: no setting of analytic reached 1e-06 rad{told}"


def test_a_bench_with_parts_missing_is_a_record_that_says_so() -> None:
    from harness.bench.bench_run import all_parts, assembled
    from harness.campaign.parts import Measured

    listed = all_parts(False)
    rows = {"free rocking": [row("pymunk", "free rocking", "coarse", 1e-4, 0.001)], "one sine pulse": []}
    measured = {part.name: Measured(left=tuple(part.tasks)) for part in listed}
    measured["precision"] = Measured(rows=rows, busy_s=2.0, wall_s=1.0)
    found = assembled(listed, measured)
    assert [item["scene"] for item in found["rows"]] == ["free rocking"]
    assert found["seconds"] == 1.0
    assert any(text.startswith("Not measured yet: coverage") for text in found["sentences"])
    assert {part.name for part in listed if part.died} == {"precision", "coverage"}, (
        "what is timed by the clock is alone"
    )


def test_pieces_of_work_are_timed_in_turns() -> None:
    done: list[str] = []
    found = costs([lambda: done.append("a"), lambda: done.append("b")], repeats=3)
    assert done == ["a", "b"] * 3
    assert [item.repeats for item in found] == [3, 3]


def test_a_run_is_not_judged_by_itself() -> None:
    engine = engines.load("pymunk")
    scene = FREE.scene()
    judge = engine.simulate(scene, engine.refinement_levels(scene)[0], RunOptions())
    row = precision._chosen(FREE, scene, "pymunk", judge, "own finest rung", judge, cost(lambda: None))
    assert row["error_rad"] is None
    assert "judged" in row["failed"]


def test_a_study_that_failed_is_no_gain_of_its_store(monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import dataclass

    from harness.studies import study_run as study

    @dataclass
    class Summary:
        wanted: int = 16
        distinct: int = 16
        computed: int = 0
        found: int = 16
        failed: int = 0

    monkeypatch.setattr(study, "run_study", lambda *args: Summary())
    assert alone.compute("cached: analytic")[0]["same"]
    monkeypatch.setattr(study, "run_study", lambda *args: Summary(failed=16))
    (row,) = alone.compute("cached: analytic")
    assert not row["same"]
    assert row["changed"] == ["16 of the runs failed"]
