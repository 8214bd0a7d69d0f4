"""The bench: errors that see a wrong run, sentences that follow from the rows, failures kept as rows."""

import json
import resource
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from harness import History, engines
from harness.comparison.scores import error_rad
from harness.engines.base import EngineFailure
from harness.model import SKIPS, RunOptions
from harness.questions.bench import bench_run
from harness.questions.bench.bench_run import BENCH
from harness.questions.bench.parts import cost, costs, head, peak_memory_mb, processor_s
from harness.questions.bench.standard_scenes import COLUMN, Standard, resolved, scene_of, standard_set
from harness.records.base import plain, validated
from harness.records.bench import BenchRecord, PartRow, PrecisionRow, ScalingRow, SkipRow
from tests.engines_for_tests import ready
from tests.measures import engine_defaults

FREE = Standard("short", {"duration_s": 0.4, "statue": COLUMN, "initial": {"theta_rad": 0.05}}, "analytic")


def row(engine: str, scene: str, label: str, error_rad: float, cpu_s: float, group: str = "level") -> PrecisionRow:
    """An invented row."""
    return PrecisionRow(
        engine, scene, group, label, error_rad=error_rad, wall_s=cpu_s, cpu_s=cpu_s, real_time_factor=1.0 / cpu_s
    )


ROWS = [
    row("pymunk", "easy", "coarse", 1e-4, 0.001),
    row("pymunk", "easy", "fine", 1e-5, 0.1),
    row("pymunk", "hard", "coarse", 1e-1, 0.001),
    row("pymunk", "hard", "fine", 1e-4, 0.1),
    row("pymunk", "easy", "to 1e-3", 1e-4, 0.002, group="accuracy"),
    row("pymunk", "hard", "to 1e-3", 1e-4, 0.2, group="accuracy"),
]


def test_the_choice_is_compared_with_the_fixed_level_that_meets_every_scene() -> None:
    found = bench_run.choice(ROWS, 1e-3)[0]
    assert found.fixed_s == pytest.approx(0.2)
    assert found.share == pytest.approx(0.202 / 0.2)
    assert found.worst_times == pytest.approx(2.0)
    assert found.met == 2


def test_a_level_is_known_by_its_place() -> None:
    other = [replace(item, label=f"{item.label}, {item.scene}") for item in ROWS if item.group == "level"]
    asked = [item for item in ROWS if item.group != "level"]
    assert bench_run.choice([*other, *asked], 1e-3) == bench_run.choice(ROWS, 1e-3)


def test_no_fixed_level_is_said() -> None:
    worse = [replace(item, error_rad=1.0) if item.scene == "hard" else item for item in ROWS]
    found = bench_run.choice(worse, 1e-3)[0]
    assert found.fixed_s is None
    assert found.worst_scene == "easy"
    assert found.met == 1


def test_the_slowest_scene_of_the_fastest_level_that_meets_the_target() -> None:
    assert bench_run.fastest(ROWS, 1e-3) == {"pymunk": (pytest.approx(10.0), "hard")}
    assert bench_run.fastest(ROWS, 1e-6)["pymunk"][0] == 0.0


def test_findings_follow_the_rows() -> None:
    (met,) = bench_run.speeds(ROWS, 1e-3)
    assert (met.code, met.values["scene"], met.values["factor"]) == ("meets_target", "hard", pytest.approx(10.0))
    assert [each.code for each in bench_run.speeds(ROWS, 1e-6)] == ["misses_target"]
    (takes,) = bench_run.takes(bench_run.choice(ROWS, 1e-3), 1e-3)
    assert (takes.engine, takes.values["met"], takes.values["worst_scene"]) == ("pymunk", 2, "easy")
    together = SkipRow("all together", "pymunk", 6, 1.0, 1.5)
    (gain,) = bench_run.together_findings([together])
    assert (gain.code, gain.values["gain"]) == ("skips_gain", 1.5)
    (change,) = bench_run.together_findings([replace(together, changed=("a: b",))])
    assert (change.code, change.values["changed"]) == ("skips_change", ["a: b"])


def test_an_error_is_seen() -> None:
    engine = engines.load("analytic")
    run = engine.simulate(FREE.scene(), engine.refinement_levels(FREE.scene())[-1], RunOptions())
    h = run.history
    assert error_rad(run, run) == 0.0
    shifted = History(h.t_s, h.theta_rad + 1e-5, h.theta_rate_rad_s, h.slip_m, h.slip_rate_m_s)
    assert error_rad(replace(run, history=shifted), run) == pytest.approx(1e-5)
    assert error_rad(replace(run, history=None), run) == np.inf


def test_rows_of_an_engine_its_defaults_and_another_project() -> None:
    ready("pybullet")
    rows = list(bench_run.rows_of(FREE, FREE.scene(), ["pymunk", "pybullet"], quick=True))
    rows += engine_defaults.rows_of(FREE, FREE.scene())
    groups = {(item.engine, item.group) for item in rows}
    assert {
        ("pymunk", "level"),
        ("pymunk", "accuracy"),
    } <= groups
    best = min(item.error_rad for item in rows if item.engine == "pybullet")
    other_project = next(item.error_rad for item in rows if item.label.startswith("virtual_shake_robot"))
    assert other_project > 3.0 * best, "compliant contact was measured to cost half a peak"
    assert all(item.cpu_s > 0.0 and item.real_time_factor > 0.0 for item in rows)
    (chosen,) = (item for item in rows if item.chosen and item.engine == "pymunk")
    assert chosen.label.startswith("--accuracy 0.001: 3 ")
    assert chosen.steps > chosen.repeats > 0
    assert chosen.stated_rad > 0.0
    assert chosen.reliable_until_s == 0.4
    assert [PrecisionRow(**asdict(item)) for item in rows] == rows


def test_a_failing_level_stays_as_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    from harness.engines.pymunk import Munk2D

    def refuses(*args: object) -> None:
        raise EngineFailure("no such scene for me")

    monkeypatch.setattr(Munk2D, "simulate", refuses)
    rows = list(bench_run.rows_of(FREE, FREE.scene(), ["pymunk"], quick=True))
    assert rows
    assert {item.failed for item in rows} == {"no such scene for me"}


def test_scenes_without_their_files_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROCKCHECK_DATA", "/nowhere")
    found, absent = resolved(standard_set())
    assert {item.name for item, _ in found} | set(absent) == {item.name for item in standard_set()}
    assert len(absent) == 5
    (row,) = bench_run.skip_rows("all together: analytic: block, elcentro1940")
    assert "elcentro1940" in row.failed
    assert bench_run.together([row])[0].failed == row.failed
    assert "elcentro1940" in bench_run.skip_rows("no_history: analytic")[0].failed
    (nobody,) = bench_run.precision_rows(True, next(iter(absent)))
    assert (nobody.engine, nobody.failed) == (bench_run.NOBODY, absent[nobody.scene])


def test_cost_is_the_least_of_several() -> None:
    calls: list[int] = []
    spent = cost(lambda: calls.append(sum(range(20_000))), repeats=4)
    assert len(calls) == spent.repeats == 4
    assert 0.0 < spent.cpu_s <= spent.wall_s * 1.5


@pytest.mark.parametrize("name", ["analytic", "pymunk"])
def test_skips_change_no_outcome_on_a_real_record(data_dir: object, name: str) -> None:
    engine = engines.load(name)
    outcomes = set()
    for scene in bench_run.outcome_scenes(bench_run.STUDY, (1.1, 6.0)):
        on, off = (
            bench_run.run_on_level(engine, scene, bench_run.ALL),
            bench_run.run_on_level(engine, scene, bench_run.NONE),
        )
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
    assert {(skip, name) for skip, named in bench_run.CASES.items() for name in named} == declared
    measured = {task.partition(": ")[0] for task in bench_run.alone_tasks(False)}
    assert measured == set(SKIPS), "what no engine declares is measured too"


def test_skips_that_gain_nothing_or_move_a_rotation_are_told() -> None:
    plain = SkipRow("quiet_end", "pymunk", 1, 1.0, 2.0, apart_rad=1e-4, own_rad=1e-3)
    rows = [
        plain, replace(plain, skip="no_history", off_s=1.01), replace(plain, skip="mirror", apart_rad=2e-3),
        replace(plain, skip="cached", changed=("computed again",)), SkipRow("planar", "*", failed="no record"),
    ]  # fmt: skip
    alone, parts, changes = bench_run.alone_findings(rows)
    assert alone.values == {"gaining": 3, "measured": 4, "idle": ["no_history (pymunk)"]}
    assert (changes.engine, changes.values) == ("pymunk", {"skip": "cached", "changed": ["computed again"]})
    assert parts.values == {"skip": "mirror", "apart_rad": 2e-3, "own_rad": 1e-3}
    assert bench_run.alone_findings([]) == []


def test_the_rows_of_a_study_are_summed_by_engine() -> None:
    rows = [SkipRow("all together", "pymunk", 3, 1.0, 4.0, outcomes=("stands",))]
    rows += [
        replace(rows[0], changed=("a",), outcomes=("lift_off",)),
        replace(rows[0], engine="analytic", failed="why"),
    ]
    both, failed = bench_run.together([*rows, replace(rows[0], engine="analytic")])
    assert both == SkipRow("all together", "pymunk", 6, 2.0, 8.0, ("a",), outcomes=("lift_off", "stands"))
    assert both.gain == 4.0
    assert failed.failed == "why"
    alone = [replace(rows[0], apart_rad=1e-6, own_rad=1e-5, steps=(3, 4))]
    (row,) = bench_run.together([*alone, replace(alone[0], apart_rad=2e-6, own_rad=0.0, steps=(1, 2))])
    assert (row.apart_rad, row.own_rad, row.steps) == (2e-6, 1e-5, [4, 6])


def test_the_own_error_of_a_run_is_what_its_finer_settings_change() -> None:
    engine, scene = engines.load("pymunk"), FREE.scene()
    run = bench_run.run_on_level(engine, scene, bench_run.NONE, bench_run.RESOLVED_RAD)
    (verification,) = engine.verification_settings(scene, bench_run.level(engine, scene, bench_run.RESOLVED_RAD))
    finer = engine.simulate(scene, verification, bench_run.NONE)
    assert bench_run.own_error_rad(engine, scene, bench_run.NONE, run) == bench_run.difference(run, finer) > 0.0


def test_how_time_grows_is_told_from_the_largest_two() -> None:
    def point(quantity: str, value: float, wall_s: float) -> ScalingRow:
        return ScalingRow("pymunk", quantity, value, wall_s, 1.0)

    rows = [point("duration_s", 2.0, 0.9), point("duration_s", 8.0, 1.0), point("duration_s", 32.0, 4.0)]
    rows += [point("workers", 1.0, 3.0), point("workers", 2.0, 2.0), point("runs", 100.0, 1.0)]
    grows, faster = bench_run.scaling_findings(rows)
    assert (grows.engine, grows.values["quantity"]) == ("pymunk", "duration_s")
    assert grows.values["power"] == pytest.approx(1.0)
    assert faster.values == {"workers": 2.0, "fewer": 1.0, "times": 1.5}
    assert bench_run.scaling_findings([]) == []


def test_the_memory_of_workers_is_counted() -> None:
    code = "import sys; sys.stdout.write(str(len(bytearray(300_000_000))))"
    before_s = processor_s()
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
    assert peak_memory_mb(resource.RUSAGE_CHILDREN) > 250.0
    assert processor_s() > before_s


def test_a_bench_with_parts_missing_is_a_record_that_says_so() -> None:
    listed = BENCH.parts(False)
    spent = [PartRow(part.name, 0.0, 0, part.tasks) for part in listed]
    spent[0] = PartRow("precision", 1.0, 2, (), 2.0)
    rows = dict.fromkeys([part.name for part in listed], ())
    timed = {"precision": [row("pymunk", "free rocking", "coarse", 1e-4, 0.001)]}
    found = BENCH.assembled(rows | timed, head("rockcheck bench", spent))
    assert [item.scene for item in found.rows] == ["free rocking"]
    assert found.seconds == 1.0
    (left,) = (each for each in found.findings if each.code == "parts_left")
    assert left.values["parts"]["alone"] == len(next(each for each in listed if each.name == "alone").tasks)
    assert plain(validated(BenchRecord, json.dumps(plain(found)), Path("result.json"))) == plain(found)
    assert [part.name for part in listed if not part.died] == ["workers"], "what is timed by the clock is alone"


def test_pieces_of_work_are_timed_in_turns() -> None:
    done: list[str] = []
    found = costs([lambda: done.append("a"), lambda: done.append("b")], repeats=3)
    assert done == ["a", "b"] * 3
    assert [item.repeats for item in found] == [3, 3]


def test_a_run_is_not_judged_by_itself() -> None:
    engine = engines.load("pymunk")
    scene = FREE.scene()
    judge = engine.simulate(scene, engine.refinement_levels(scene)[0], RunOptions())
    row = bench_run._chosen(PrecisionRow("pymunk", "short", "accuracy", ""), judge, judge, cost(lambda: None))
    assert row.error_rad is None
    assert "judged" in row.failed


def test_a_study_that_failed_is_no_gain_of_its_store(monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import dataclass

    from harness.questions.study import study_run as study

    @dataclass
    class Summary:
        wanted: int = 16
        distinct: int = 16
        computed: int = 0
        found: int = 16
        failed: int = 0

    monkeypatch.setattr(study, "run_study", lambda *args: Summary())
    assert bench_run.skip_rows("cached: analytic")[0].changed == ()
    monkeypatch.setattr(study, "run_study", lambda *args: Summary(failed=16))
    (row,) = bench_run.skip_rows("cached: analytic")
    assert row.changed == ("16 of the runs failed",)
